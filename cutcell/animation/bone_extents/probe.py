"""Point and ray queries on the body: inside, part inside, exit."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...bones.nearest import NodeGrid
from ...geometry.segments import closest_on_segment
from ...geometry.vectors import TIE
from ...graph import CutCellGraph

RAY_STEP = 0.25
"""Lattice cells between sample points on a ray."""
ENTRY = 5
"""Steps within which a ray must enter the body: a joint may lie slightly outside the skin."""
AT_A_TIME = 32
"""Sample points on a ray that are tested at a time, more than `ENTRY`."""
SIGHT_SAMPLES = np.linspace(0, 1, 17)
"""Sample points on a segment."""
MIN_SIGHT = 0.85
"""The part of a segment that must run inside for line of sight between its ends."""
NEARER_BONE = 0.999
"""A bone is nearer than the ray's start if its distance is below this factor of the start's."""
PAIRS = 500
"""Sample points and bones that are tested for line of sight at a time."""


class BodyProbe:
    """Answers point and ray queries on the body, accurate to about a lattice cell.

    Parameters
    ----------
    graph : CutCellGraph
        Points are in its unit cube.
    grid : NodeGrid
        Of its nodes.
    """

    def __init__(self, graph: CutCellGraph, grid: NodeGrid) -> None:
        self._grid = grid
        self.lattice, self.resolution = graph.lattice, graph.lattice.resolution
        interior = graph.interior
        column = np.repeat(np.arange(self.resolution**2), np.diff(interior.start))
        # Stretches of lattice points inside, numbered over the whole lattice.
        self._first = (column * self.resolution + interior.first).astype(np.float64)
        self._last = np.append(-1, column * self.resolution + interior.last)  # of that before

    def inside(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return for each point (..., 3) whether its lattice cell's centre is inside."""
        cell = np.floor((np.asarray(points, np.float64) + TIE) * self.resolution)
        # Whole numbers below 2^53: exact, and those of points outside the cube do not matter.
        place = cell @ np.array([self.resolution**2, self.resolution, 1.0])
        stretch = np.searchsorted(self._first, place, side="right")
        is_inside: NDArray[np.bool_] = place <= self._last[stretch]
        return is_inside & ((cell >= 0) & (cell < self.resolution)).all(axis=-1)

    def near(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return whether the body is in or beside the lattice cell of each point (..., 3)."""
        points = np.asarray(points, np.float64)
        return self._grid.near(points.reshape(-1, 3)).reshape(points.shape[:-1])

    def inner_part(
        self, start: ArrayLike, end: ArrayLike, *, strictly: bool = False
    ) -> NDArray[np.float64]:
        """Return the part of each segment (..., 3) that runs near the body, or strictly inside."""
        start, end = np.broadcast_arrays(np.asarray(start, float), np.asarray(end, float))
        points = start[..., None, :] + SIGHT_SAMPLES[:, None] * (end - start)[..., None, :]
        return (self.inside if strictly else self.near)(points).mean(axis=-1)

    def exit_distance(
        self, start: NDArray[np.float64], direction: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Compute where rays from points (p, 3) leave the body; zero if they never enter it."""
        distance, step = np.zeros(len(start)), RAY_STEP / self.resolution
        rays = np.arange(len(start))
        for first in range(0, int(2 / step), AT_A_TIME):  # at most across the cube
            away = (first + np.arange(AT_A_TIME)) * step
            points = start[rays, None] + away[:, None] * direction[rays, None]
            is_inside = self.inside(points)
            if first == 0:
                enters = is_inside[:, :ENTRY].any(axis=1)
                rays, is_inside = rays[enters], is_inside[enters]
                is_inside[np.arange(AT_A_TIME) < is_inside.argmax(axis=1)[:, None]] = True
            leaves = ~is_inside.all(axis=1)
            distance[rays[leaves]] = away[is_inside[leaves].argmin(axis=1)]
            rays = rays[~leaves]
            if not len(rays):
                break
        return distance

    def distance_to_others(
        self,
        start: NDArray[np.float64],
        direction: NDArray[np.float64],
        limit: NDArray[np.float64],
        others: Iterable[tuple[NDArray[np.float64], NDArray[np.float64]]],
    ) -> NDArray[np.float64]:
        """Compute where rays come nearer, through the body, to other segments than to their start.

        Shapes: start, direction (p, 3), limit (p,), others (b, 3); returns (p,).
        """
        rays = zip(start, direction, limit, others, strict=True)
        return np.array([self._distance_to_others(*ray) for ray in rays])

    def _distance_to_others(self, start, direction, limit, others):
        """Compute the same for one ray: start (3,), direction (3,), limit ()."""
        step = 2 * RAY_STEP / self.resolution
        away = np.arange(1, int(limit / step) + 1) * step
        points = start + away[:, None] * direction
        nearest, _ = closest_on_segment(points[:, None], *others)
        offset = nearest - points[:, None]
        near = (offset**2).sum(axis=2) <= ((NEARER_BONE * away) ** 2)[:, None]
        k, other = near.nonzero()
        for pairs in np.split(np.arange(len(k)), range(PAIRS, len(k), PAIRS)):
            to_other = offset[k[pairs], other[pairs], None]
            segments = points[k[pairs], None] + SIGHT_SAMPLES[:, None] * to_other
            sees = self.inside(segments).mean(axis=1) >= MIN_SIGHT
            if sees.any():
                return away[k[pairs[sees.argmax()]]]
        return limit
