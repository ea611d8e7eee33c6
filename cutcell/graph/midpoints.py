"""The segments of rays one by one, for those who ask about each midpoint by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .rays import AXES, Crossings
from .segments import NONE, Runs


@dataclass(frozen=True, eq=False)
class Segments:
    """All segments of the rays of one axis, in order: ray by ray, upward.

    Gap c of a ray ends at the crossing c (or at the cube's wall), segment s of a gap at
    the lattice point s (or, the last one, where the gap does). Segments that begin or end
    at the cube's wall lack an end.
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

    def runs(self, kept: NDArray[np.bool_]) -> Runs:
        """Join kept segments that follow one another within a gap."""
        before, after = np.zeros(len(kept), bool), np.zeros(len(kept), bool)
        before[1:], after[:-1] = kept[:-1], kept[1:]
        begin = np.flatnonzero(kept & (self.is_first | ~before))
        end = np.flatnonzero(kept & (self.is_last | ~after))
        at_crossing = self.is_first[begin]
        first = self.number[begin] - ~at_crossing
        low = np.where(at_crossing, self.gap[begin] - 1, NONE)
        high = np.where(self.is_last[end], self.gap[end], NONE)
        last = self.number[end] - self.is_last[end]
        return Runs(
            self.ray[begin].astype(np.int32),
            first.astype(np.int32),
            last.astype(np.int32),
            low,
            high,
        )


def list_segments(crossings: Crossings, resolution: int, closed: bool) -> Segments:
    """Dice rays by crossings and lattice points; a closed mesh leaves rays without any out."""
    count = np.diff(crossings.start)
    rays = np.flatnonzero(count > 0) if closed else np.arange(resolution**2)
    lattice = (np.arange(resolution) + 0.5) / resolution
    gaps = count[rays] + 1
    ray = np.repeat(rays, gaps)
    place = np.arange(len(ray)) - np.repeat(np.cumsum(gaps) - gaps, gaps)
    from_wall, to_wall = place == 0, place == count[ray]
    gap = crossings.start[ray] + place
    # A padded list of positions spares the walls a case of their own.
    position = np.concatenate([crossings.position, [0.0]])
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
