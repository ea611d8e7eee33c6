"""Inside intervals by libigl's fast winding number at every midpoint.

A cross-check of `graph/winding/intervals.py`. The fast winding number is a truncated series:
segments whose number is within about 1e-2 of tau may be decided otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .ray_tracers import optional_library
from .rays import AXES, RayHits
from .winding.boundary import find_boundary
from .winding.intervals import InsideIntervals
from .winding.segments import NONE


@dataclass(frozen=True, eq=False)
class Segments:
    """All segments of the rays of one axis, ray by ray, upward.

    Gap c of a ray ends at the hit c (or at the wall of the cube), segment s of a gap at the
    lattice point s (or, the last one, where the gap does). Segments that begin or end at the wall
    lack an end.
    """

    ray: NDArray[np.int64]
    gap: NDArray[np.int64]
    number: NDArray[np.int64]
    is_first: NDArray[np.bool_]
    is_last: NDArray[np.bool_]
    has_ends: NDArray[np.bool_]
    middle: NDArray[np.float64]

    def points(self, resolution: int, axis: int) -> NDArray[np.float64]:
        """Return the midpoints in the unit cube, shape (s, 3)."""
        u, v, along = AXES[axis]
        points = np.empty((len(self.ray), 3))
        points[:, u] = (self.ray // resolution + 0.5) / resolution
        points[:, v] = (self.ray % resolution + 0.5) / resolution
        points[:, along] = self.middle
        return points

    def intervals(self, kept: NDArray[np.bool_]) -> InsideIntervals:
        """Join consecutive kept segments within a gap."""
        before, after = np.zeros(len(kept), bool), np.zeros(len(kept), bool)
        before[1:], after[:-1] = kept[:-1], kept[1:]
        begin = np.flatnonzero(kept & (self.is_first | ~before))
        end = np.flatnonzero(kept & (self.is_last | ~after))
        at_hit = self.is_first[begin]
        first = self.number[begin] - ~at_hit
        low = np.where(at_hit, self.gap[begin] - 1, NONE)
        high = np.where(self.is_last[end], self.gap[end], NONE)
        last = self.number[end] - self.is_last[end]
        return InsideIntervals(
            self.ray[begin].astype(np.int32),
            first.astype(np.int32),
            last.astype(np.int32),
            low,
            high,
        )


def list_segments(hits: RayHits, resolution: int, closed: bool) -> Segments:
    """Divide rays at hits and lattice points; of a closed mesh leave out rays without hits."""
    count = np.diff(hits.start)
    rays = np.flatnonzero(count > 0) if closed else np.arange(resolution**2)
    lattice = (np.arange(resolution) + 0.5) / resolution
    gaps = count[rays] + 1
    ray = np.repeat(rays, gaps)
    number_in_ray = np.arange(len(ray)) - np.repeat(np.cumsum(gaps) - gaps, gaps)
    from_wall, to_wall = number_in_ray == 0, number_in_ray == count[ray]
    gap = hits.start[ray] + number_in_ray
    # Padded, so that the walls need no case of their own.
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
    middle = (left + right) / 2
    return Segments(ray[of], gap[of], number, is_first, is_last, has_ends, middle)


def fast_intervals(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    hits: RayHits,
    resolution: int,
    axis: int,
    winding_threshold: float,
) -> InsideIntervals:
    """Find the kept segments along one axis by libigl's fast winding number at midpoints.

    Shapes: vertices (n, 3), faces (m, 3).

    References
    ----------
    Barill, Dickson, Schmidt, Levin & Jacobson, "Fast winding numbers for soups and
    clouds", 2018.
    """
    igl = optional_library("igl", 'winding="fast"', "libigl")
    closed = len(find_boundary(faces).loop) == 0
    segments = list_segments(hits, resolution, closed)
    kept = np.zeros(len(segments.ray), bool)
    complete = np.flatnonzero(segments.has_ends)
    points = segments.points(resolution, axis)[complete]
    if len(complete):
        number = igl.fast_winding_number(vertices, faces.astype(np.int64), points)
        kept[complete] = number >= winding_threshold
    return segments.intervals(kept)
