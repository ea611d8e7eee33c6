"""Questions about the body that a point in space can ask of the graph."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled import compiled
from ..graph import CutCellGraph
from ..graph.interior import OUTSIDE, point_number
from .nearest import NodeGrid

STEP = 0.25
"""Lattice cells between the points at which a ray is looked at."""
ENTRY = 5
"""Steps within which a ray must have come inside; a joint may lie right under the skin."""
ALONG = np.linspace(0, 1, 17)
"""Where a segment is looked at."""


class BodyProbe:
    """Tells what is inside the body, how thick it is, and where a ray leaves it.

    All is known to about a lattice cell: enough to say where a bone ends.

    Parameters
    ----------
    graph : CutCellGraph
        Points are in its unit cube.
    grid : NodeGrid
        Of its nodes.
    """

    def __init__(self, graph: CutCellGraph, grid: NodeGrid) -> None:
        self._graph = graph
        self._grid = grid
        self._resolution = graph.lattice.resolution

    def inside(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Tell for each point (..., 3) whether its lattice cell's centre is inside."""
        points = np.asarray(points, np.float64)
        found = _inside(points.reshape(-1, 3), self._resolution, self._graph.interior.table)
        return found.reshape(points.shape[:-1])

    def near(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Tell for each point (..., 3) whether the body is in its lattice cell or next to it."""
        points = np.asarray(points, np.float64)
        return self._grid.beside(points.reshape(-1, 3)).reshape(points.shape[:-1])

    def inner_part(
        self, start: ArrayLike, end: ArrayLike, *, strictly: bool = False
    ) -> NDArray[np.float64]:
        """Return which part of each segment (..., 3) runs near the body, or strictly inside."""
        start, end = np.broadcast_arrays(np.asarray(start, float), np.asarray(end, float))
        points = start[..., None, :] + ALONG[:, None] * (end - start)[..., None, :]
        return (self.inside if strictly else self.near)(points).mean(axis=-1)

    def depth(self, points: ArrayLike) -> NDArray[np.float64]:
        """Measure from each point (p, 3) to the nearest skin; zero outside."""
        points, graph = np.asarray(points, np.float64), self._graph
        skin = graph.nodes[: graph.first_point], graph.nodes[graph.first_crossing :]
        away = np.minimum(*(_to_nearest(points, nodes) for nodes in skin))
        return np.where(self.inside(points), away, 0.0)

    def way_out(
        self, start: NDArray[np.float64], direction: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Measure how far one can go from points (p, 3) until outside; zero if never inside."""
        table, step = self._graph.interior.table, STEP / self._resolution
        return _ways_out(start, direction, step, self._resolution, table)


@compiled
def _inside(points, resolution, table):
    found = np.empty(len(points), np.bool_)
    for p in range(len(points)):
        found[p] = _is_inside(resolution, table, points[p, 0], points[p, 1], points[p, 2])
    return found


@compiled(inline="always")
def _is_inside(resolution, table, x, y, z):
    start, first, last, number = table
    x, y, z = np.floor(x * resolution), np.floor(y * resolution), np.floor(z * resolution)
    if not (0 <= x < resolution and 0 <= y < resolution and 0 <= z < resolution):
        return False
    column = int(x) * resolution + int(y)
    return point_number(start, first, last, number, column, int(z)) != OUTSIDE


@compiled
def _ways_out(start, direction, step, resolution, table):
    away = np.zeros(len(start))
    for p in range(len(start)):
        was_inside = False
        for k in range(int(2 / step)):  # across the cube, whichever way
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
def _to_nearest(points, others):
    result = np.empty(len(points))
    for p in range(len(points)):
        least = np.inf
        for o in range(len(others)):
            x = points[p, 0] - others[o, 0]
            y = points[p, 1] - others[o, 1]
            z = points[p, 2] - others[o, 2]
            least = min(least, x * x + y * y + z * z)
        result[p] = np.sqrt(least)
    return result
