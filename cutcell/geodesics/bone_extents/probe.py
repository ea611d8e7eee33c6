"""Point and ray queries on the body: inside, part inside, exit."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...geometry.vectors import segment_fraction
from ...graph import CutCellGraph
from ...graph.interior import OUTSIDE, point_number
from ...runtime.compiled import compiled
from ..nearest import NodeTree

STEP = 0.25
"""Lattice cells between sample points on a ray."""
ENTRY = 5
"""Steps within which a ray must enter the body: a joint may lie slightly outside the skin."""
ALONG = np.linspace(0, 1, 17)
"""Sample points on a segment."""
SEEN = 0.85
"""The part of a segment that must run inside for line of sight between its ends."""
NEARER = 0.999
"""A bone is nearer than the ray's start if its distance is below this factor of the start's."""


class BodyProbe:
    """Answers point and ray queries on the body, accurate to about a lattice cell.

    Parameters
    ----------
    graph : CutCellGraph
        Points are in its unit cube.
    tree : NodeTree
        Of its nodes.
    """

    def __init__(self, graph: CutCellGraph, tree: NodeTree) -> None:
        self._graph = graph
        self._tree = tree
        self.resolution = graph.lattice.resolution

    def inside(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return for each point (..., 3) whether its lattice cell's centre is inside."""
        points = np.asarray(points, np.float64)
        is_inside = _inside(points.reshape(-1, 3), self.resolution, self._graph.interior.table)
        return is_inside.reshape(points.shape[:-1])

    def near(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return whether the body is in or beside the lattice cell of each point (..., 3)."""
        points = np.asarray(points, np.float64)
        return self._tree.near(points.reshape(-1, 3)).reshape(points.shape[:-1])

    def inner_part(
        self, start: ArrayLike, end: ArrayLike, *, strictly: bool = False
    ) -> NDArray[np.float64]:
        """Return the part of each segment (..., 3) that runs near the body, or strictly inside."""
        start, end = np.broadcast_arrays(np.asarray(start, float), np.asarray(end, float))
        points = start[..., None, :] + ALONG[:, None] * (end - start)[..., None, :]
        return (self.inside if strictly else self.near)(points).mean(axis=-1)

    def exit_distance(
        self, start: NDArray[np.float64], direction: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Compute where rays from points (p, 3) leave the body; zero if they never enter it."""
        table, step = self._graph.interior.table, STEP / self.resolution
        return _exit_distances(start, direction, step, self.resolution, table)

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
        table, step = self._graph.interior.table, 2 * STEP / self.resolution
        return np.array(
            [
                _distance_to_others(*ray, *segments, step, self.resolution, table)
                for *ray, segments in zip(start, direction, limit, others, strict=True)
            ]
        )


@compiled
def _inside(points, resolution, table):
    is_inside = np.empty(len(points), np.bool_)
    for p in range(len(points)):
        is_inside[p] = _is_inside(resolution, table, points[p, 0], points[p, 1], points[p, 2])
    return is_inside


@compiled(inline="always")
def _is_inside(resolution, table, x, y, z):
    start, first, last, number = table
    x, y, z = np.floor(x * resolution), np.floor(y * resolution), np.floor(z * resolution)
    if not (0 <= x < resolution and 0 <= y < resolution and 0 <= z < resolution):
        return False
    column = int(x) * resolution + int(y)
    return point_number(start, first, last, number, column, int(z)) != OUTSIDE


@compiled
def _exit_distances(start, direction, step, resolution, table):
    away = np.zeros(len(start))
    for p in range(len(start)):
        was_inside = False
        for k in range(int(2 / step)):  # at most across the cube
            x, y, z = (
                start[p, 0] + k * step * direction[p, 0],
                start[p, 1] + k * step * direction[p, 1],
                start[p, 2] + k * step * direction[p, 2],
            )
            is_inside = _is_inside(resolution, table, x, y, z)
            if was_inside and not is_inside:
                away[p] = k * step
                break
            if not is_inside and k + 1 == ENTRY:
                break
            was_inside = is_inside
    return away


@compiled
def _distance_to_others(point, direction, limit, start, end, step, resolution, table):
    for k in range(1, int(limit / step) + 1):
        p = point + k * step * direction
        for b in range(len(start)):
            offset = start[b] + segment_fraction(start[b], end[b], p) * (end[b] - start[b]) - p
            if (offset * offset).sum() > (NEARER * k * step) ** 2:
                continue
            inside = 0
            for share in ALONG:
                x, y, z = p + share * offset
                inside += _is_inside(resolution, table, x, y, z)
            if inside >= SEEN * len(ALONG):
                return k * step
    return limit
