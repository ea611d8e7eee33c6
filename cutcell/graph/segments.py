"""Algorithm 1's segments of rays, and which of them are kept (paper section 3.1).

Ray hits and lattice points divide each ray into segments. A segment is kept if the winding number
at its midpoint is at least tau. This is the plain version, which lists all segments: it defines
the result, and works with any winding number. `winding/treecode/intervals.py` returns the same
intervals without listing them, so that its memory grows with the surface, not with the volume.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .rays import RayHits, points_on_rays
from .surface import Surface

NONE = -1


@dataclass(frozen=True, eq=False)
class InsideIntervals:
    """Maximal intervals of kept segments on the rays of one axis, in the order of the rays.

    An interval runs from a hit (or NONE) over the lattice points `first` to `last` to the next hit
    (or NONE). It holds no lattice point if `last` is below `first`.

    Parameters
    ----------
    ray, first, last, low, high : arrays, shape (r,), int32
        `low` and `high` are indices into the `RayHits` of the axis, or -1.
    """

    ray: NDArray[np.int32]
    first: NDArray[np.int32]
    last: NDArray[np.int32]
    low: NDArray[np.int32]
    high: NDArray[np.int32]


def inside_intervals(
    surface: Surface,
    hits: Sequence[RayHits],
    winding_threshold: float,
    winding_number: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> list[InsideIntervals]:
    """Keep the segments along x, y and z whose midpoints have a winding number of at least tau.

    Parameters
    ----------
    surface : Surface
    hits : sequence of RayHits
        Of the rays along x, y and z.
    winding_threshold : float
        tau.
    winding_number : callable
        Returns the winding numbers (q,) of the surface at points (q, 3) of the unit cube.
    """
    inside = []
    for axis, hits_along in enumerate(hits):
        # On a closed mesh, rays without hits are outside.
        is_divided = (np.diff(hits_along.start) > 0) | (not surface.is_closed)
        segments = divide_rays(hits_along, np.flatnonzero(is_divided), surface.resolution)
        midpoints = segments.points((segments.low + segments.high) / 2, surface.resolution, axis)
        w = np.full(len(midpoints), -np.inf)  # segments to a wall of the cube are outside
        w[segments.has_ends] = winding_number(midpoints[segments.has_ends])
        inside.append(segments.intervals(w >= winding_threshold))
    return inside


@dataclass(frozen=True, eq=False)
class Segments:
    """Segments of the rays of one axis, ray by ray, upward.

    Gap c of a ray ends at the hit c (or at the wall of the cube), segment s of a gap at the
    lattice point s (or, the last one, where the gap does). Segments that begin or end at the wall
    lack an end.

    Parameters
    ----------
    ray, gap, number : arrays, shape (s,), int64
    is_first, is_last, has_ends : arrays, shape (s,), bool
        Whether a segment is the first or last of its gap, and whether it has both ends.
    low, high : arrays, shape (s,), float64
        Where it begins and ends along the ray.
    """

    ray: NDArray[np.int64]
    gap: NDArray[np.int64]
    number: NDArray[np.int64]
    is_first: NDArray[np.bool_]
    is_last: NDArray[np.bool_]
    has_ends: NDArray[np.bool_]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    def points(
        self, position: NDArray[np.float64], resolution: int, axis: int
    ) -> NDArray[np.float64]:
        """Return the points at a position along the ray of each segment, shape (s, 3)."""
        return points_on_rays(self.ray, position, resolution, axis)

    def intervals(self, is_kept: NDArray[np.bool_]) -> InsideIntervals:
        """Join consecutive kept segments within a gap."""
        before, after = np.zeros(len(is_kept), bool), np.zeros(len(is_kept), bool)
        before[1:], after[:-1] = is_kept[:-1], is_kept[1:]
        begin = np.flatnonzero(is_kept & (self.is_first | ~before))
        end = np.flatnonzero(is_kept & (self.is_last | ~after))
        at_hit = self.is_first[begin]
        first = self.number[begin] - ~at_hit
        low = np.where(at_hit, self.gap[begin] - 1, NONE)
        high = np.where(self.is_last[end], self.gap[end], NONE)
        last = self.number[end] - self.is_last[end]
        columns = self.ray[begin], first, last, low, high
        return InsideIntervals(*(column.astype(np.int32) for column in columns))


def divide_rays(hits: RayHits, rays: NDArray[np.intp], resolution: int) -> Segments:
    """Divide rays of one axis, shape (r,), ascending, at their hits and at the lattice points."""
    count = np.diff(hits.start)
    lattice = (np.arange(resolution) + 0.5) / resolution
    gaps = count[rays] + 1
    ray = np.repeat(rays, gaps)
    number_in_ray = np.arange(len(ray)) - np.repeat(np.cumsum(gaps) - gaps, gaps)
    from_wall, to_wall = number_in_ray == 0, number_in_ray == count[ray]
    gap = hits.start[ray] + number_in_ray
    # Padded, so that the walls are no special case.
    position = np.concatenate([hits.position, [0.0]])
    low = np.where(from_wall, 0.0, position[gap - 1])
    high = np.where(to_wall, 1.0, position[np.minimum(gap, len(position) - 1)])
    first = np.where(from_wall, 0, np.searchsorted(lattice, low))
    beyond = np.where(to_wall, resolution, np.searchsorted(lattice, high))

    size = beyond - first + 1
    of = np.repeat(np.arange(len(ray)), size)
    number = first[of] + np.arange(len(of)) - np.repeat(np.cumsum(size) - size, size)
    is_first, is_last = number == first[of], number == beyond[of]
    left = np.where(is_first, low[of], (number - 0.5) / resolution)
    right = np.where(is_last, high[of], (number + 0.5) / resolution)
    has_ends = ~((is_first & from_wall[of]) | (is_last & to_wall[of]))
    return Segments(ray[of], gap[of], number, is_first, is_last, has_ends, left, right)
