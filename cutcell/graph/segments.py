"""Algorithm 1's segments of rays, and which of them are kept (paper section 3.1).

Ray hits and lattice points divide each ray into segments. A segment is kept if the winding number
at its midpoint is at least tau.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import no_refcount
from ..runtime.progress import Tell
from ..runtime.threads import in_threads
from .rays import RayHits, first_at_least, points_on_rays
from .surface import Surface

NONE = -1
CHUNK = 2**19
"""Segments that are divided and decided together."""


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


@dataclass(frozen=True, eq=False)
class Segments:
    """Segments of rays of one axis, ray by ray, upward; those that end at a wall are left out.

    Gap c of a ray ends at the hit c (or at the wall of the cube), segment s of a gap at the
    lattice point s (or, the last one, where the gap does).

    Parameters
    ----------
    axis, resolution : int
    ray, gap, number : arrays, shape (s,), int32
    from_hit, to_hit : arrays, shape (s,), bool
        Whether a segment begins or ends at a hit; else at a lattice point.
    middle : array, shape (s,), float64
        Its midpoint along the ray.
    """

    axis: int
    resolution: int
    ray: NDArray[np.int32]
    gap: NDArray[np.int32]
    number: NDArray[np.int32]
    from_hit: NDArray[np.bool_]
    to_hit: NDArray[np.bool_]
    middle: NDArray[np.float64]

    def midpoints(self, which: slice | NDArray[np.intp] = np.s_[:]) -> NDArray[np.float64]:
        """Return the midpoints of some segments in the unit cube, shape (q, 3)."""
        return points_on_rays(self.ray[which], self.middle[which], self.resolution, self.axis)

    def intervals(self, is_inside: NDArray[np.bool_]) -> InsideIntervals:
        """Join consecutive segments inside, within a gap."""
        is_next = np.zeros(len(is_inside) + 1, np.bool_)
        is_next[1:-1] = is_inside[1:] & is_inside[:-1] & ~self.from_hit[1:]
        is_next[1:-1] &= self.ray[1:] == self.ray[:-1]
        begin = np.flatnonzero(is_inside & ~is_next[:-1])
        end = np.flatnonzero(is_inside & ~is_next[1:])
        from_hit, to_hit = self.from_hit[begin], self.to_hit[end]
        return InsideIntervals(
            self.ray[begin],
            self.number[begin] - ~from_hit,
            self.number[end] - to_hit,
            np.where(from_hit, self.gap[begin] - 1, NONE).astype(np.int32),
            np.where(to_hit, self.gap[end], NONE).astype(np.int32),
        )


class RayWindingNumbers(Protocol):
    """Winding numbers of a surface along its rays: exact ones by a treecode, or libigl's."""

    def in_gaps(self, axis: int) -> NDArray[np.float64] | None:
        """Return the winding number in the gap before each hit, shape (c,), if the mesh is closed.

        Then it is constant between two hits, and below tau beyond the first and last of a ray.
        """

    def beyond_hits(self, axis: int) -> NDArray[np.int32]:
        """Return which lattice points may be inside before a ray's first hit or beyond its last.

        Shape (R * R, 2): the first and the last on each ray.
        """

    def at_midpoints(self, segments: Segments) -> NDArray[np.float64]:
        """Return w or tau + floor(w - tau), of the winding number w of each midpoint, (s,)."""


@dataclass(frozen=True, eq=False)
class PointwiseWindingNumbers:
    """Winding numbers by a function of points (q, 3) of the unit cube that returns numbers (q,)."""

    surface: Surface
    function: Callable[[NDArray[np.float64]], NDArray[np.float64]]

    def in_gaps(self, axis: int) -> None:
        """Return None: an approximate number is not constant."""

    def beyond_hits(self, axis: int) -> NDArray[np.int32]:
        """See `RayWindingNumbers`."""
        resolution = self.surface.resolution
        ends = (resolution, NONE) if self.surface.mesh.is_closed else (0, resolution)
        return np.tile(np.array(ends, np.int32), (resolution**2, 1))

    def at_midpoints(self, segments: Segments) -> NDArray[np.float64]:
        """See `RayWindingNumbers`."""
        return self.function(segments.midpoints())


def inside_intervals(
    hits: Sequence[RayHits],
    tau: float,
    winding_numbers: RayWindingNumbers,
    resolution: int,
    report: Tell = lambda done: None,
) -> list[InsideIntervals]:
    """Keep the segments along x, y and z whose midpoints have a winding number of at least tau."""

    def keep(chunk: tuple[int, NDArray[np.intp]]) -> InsideIntervals:
        axis, rays = chunk
        segments = divide_rays(hits[axis], axis, resolution, rays, beyond_hits[axis])
        # The winding number w, or tau + floor(w - tau): either is at least tau where the other is.
        floored_w = winding_numbers.at_midpoints(segments)
        return segments.intervals(floored_w >= tau)

    in_gaps = [w for axis in range(3) if (w := winding_numbers.in_gaps(axis)) is not None]
    if in_gaps:
        return in_threads(
            lambda axis: gap_intervals(hits[axis], in_gaps[axis] >= tau, resolution),
            range(3),
            report,
        )
    beyond_hits = [winding_numbers.beyond_hits(axis) for axis in range(3)]
    chunks = [
        (axis, rays)
        for axis in range(3)
        for rays in _chunks(hits[axis], beyond_hits[axis], resolution)
    ]
    intervals = in_threads(keep, chunks, report)
    inside = []
    for axis in range(3):
        parts = [vars(part) for (of, _), part in zip(chunks, intervals, strict=True) if of == axis]
        inside.append(
            InsideIntervals(**{n: np.concatenate([part[n] for part in parts]) for n in parts[0]})
        )
    return inside


def gap_intervals(hits: RayHits, is_inside: NDArray[np.bool_], resolution: int) -> InsideIntervals:
    """Return the intervals of gaps inside, each before a hit, (c,); not those from a wall."""
    count = np.diff(hits.start)
    is_inside[hits.start[:-1][count > 0]] = False
    high = np.flatnonzero(is_inside).astype(np.int32)
    ray = np.repeat(np.arange(len(count), dtype=np.int32), count)[high]
    # As `first_at_least`.
    position, half = hits.position, 0.5
    first = np.maximum(np.ceil(position * resolution - half), 0).astype(np.int32)
    first -= (first > 0) & ((first - half) / resolution >= position)
    first += (first + half) / resolution < position
    return InsideIntervals(ray, first[high - 1], first[high] - 1, high - 1, high)


def _chunks(
    hits: RayHits, beyond_hits: NDArray[np.int32], resolution: int
) -> list[NDArray[np.intp]]:
    """Divide the rays that may be inside into chunks of about CHUNK segments at most."""
    rays = np.flatnonzero((np.diff(hits.start) > 0) | (beyond_hits[:, 0] <= beyond_hits[:, 1]))
    return np.split(rays, range(CHUNK // resolution, len(rays), CHUNK // resolution))


def divide_rays(
    hits: RayHits,
    axis: int,
    resolution: int,
    rays: NDArray[np.intp],
    beyond_hits: NDArray[np.int32],
) -> Segments:
    """Divide rays, shape (r,), of one axis at their hits and at the lattice points.

    `beyond_hits`, shape (R * R, 2): as of `RayWindingNumbers`.
    """
    count = int(np.diff(hits.start)[rays].sum()) + len(rays) * (resolution + 1)
    types = np.int32, np.int32, np.int32, np.bool_, np.bool_, np.float64
    out: list[NDArray[Any]] = [np.empty(count, dtype) for dtype in types]
    count = _divide(hits.start, hits.position, resolution, rays, beyond_hits, *out)
    return Segments(axis, resolution, *(values[:count] for values in out))


@no_refcount
def _divide(
    start, position, resolution, rays, beyond_hits, ray, gap, number, from_hit, to_hit, middle
):
    """Fill in the arrays of `Segments`; return how many there are."""
    s = 0
    for r in rays:
        begin, end = start[r], start[r + 1]
        first, last = max(1, beyond_hits[r, 0]), 0  # what ends at a wall is outside
        for c in range(begin, end + 1):
            if c < end:
                last = first_at_least(position[c], resolution)
            else:
                last = min(resolution - 1, beyond_hits[r, 1])
            low = position[c - 1] if c > begin else (first - 0.5) / resolution
            for k in range(first, last + 1):
                is_last = c < end and k == last
                high = position[c] if is_last else (k + 0.5) / resolution
                ray[s], gap[s], number[s] = r, c, k
                from_hit[s], to_hit[s] = c > begin and k == first, is_last
                middle[s] = 0.5 * (low + high)
                low = high
                s += 1
            first = last
    return s
