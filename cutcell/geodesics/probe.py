"""Questions about the body that a point in space can ask of the graph."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from ..graph import INTERIOR, CutCellGraph
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
        cells = np.floor(points.reshape(-1, 3) * self._resolution).astype(np.int64)
        found = _inside(cells, self._resolution, *self._graph.interior.table)
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
        points = np.asarray(points, np.float64)
        skin = self._graph.nodes[self._graph.node_kind != INTERIOR]
        return np.where(self.inside(points), _to_nearest(points, skin), 0.0)

    def way_out(
        self, start: NDArray[np.float64], direction: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Measure how far one can go from points (p, 3) until outside; zero if never inside."""
        steps = np.arange(int(2 * self._resolution / STEP)) * STEP / self._resolution
        inside = self.inside(start[:, None] + steps[:, None] * direction[:, None])
        entered = np.logical_or.accumulate(inside, axis=1)
        left = (entered & ~inside).argmax(axis=1)
        return np.where(inside[:, :ENTRY].any(axis=1), steps[left], 0.0)


@njit(cache=True, nogil=True)
def _inside(cells, resolution, start, first, last, number):
    found = np.zeros(len(cells), np.bool_)
    for p in range(len(cells)):
        x, y, z = cells[p]
        if 0 <= x < resolution and 0 <= y < resolution and 0 <= z < resolution:
            column = x * resolution + y
            found[p] = point_number(start, first, last, number, column, z) != OUTSIDE
    return found


@njit(cache=True, nogil=True)
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
