"""Nearest nodes of points, and nodes in the lattice cells around them."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import MeshError
from ..geometry.vectors import TIE
from ..graph import CutCellGraph
from ..runtime.compiled import compiled, no_refcount

MAX_ACROSS = 40
"""Grid cells along each axis at most: their numbers have 16 bits, which sort in linear time."""
PER_CELL = 4
"""Nodes in a grid cell, if they were everywhere."""
CELLS_ACROSS = 2**13
"""Lattice cells along each axis that have keys of their own: points lie at most the cube beside
it."""


class NodeGrid:
    """Nodes by the cells of a grid: there are a few hundred points, and many nodes.

    Parameters
    ----------
    nodes : array, shape (N, 3)
        In the unit cube.
    chosen : array, shape (N,), bool
        Which of them may be found.
    resolution : int
        R, of the lattice that the nodes are of.
    label : array, shape (N,), integers, optional
        What each node belongs to, see `nearest`.
    """

    def __init__(
        self,
        nodes: NDArray[np.float64],
        chosen: NDArray[np.bool_],
        resolution: int,
        label: NDArray[np.integer] | None = None,
    ) -> None:
        number, self._resolution = np.flatnonzero(chosen), resolution
        across = self._across = int(np.clip(np.cbrt(len(number) / PER_CELL), 1, MAX_ACROSS))
        points = nodes[number]
        cell = np.zeros(len(number), np.uint16)
        for column in points.T:
            along = np.clip((column * across).astype(np.int16), 0, across - 1)
            cell = cell * np.uint16(across) + along.astype(np.uint16)
        order = np.argsort(cell, kind="stable")
        self._start = np.append(0, np.cumsum(np.bincount(cell, minlength=across**3)))
        self._points, self._number = points[order], number[order]
        label = np.zeros(len(nodes), np.int32) if label is None else label
        self._label = label[self._number].astype(np.int32)

    @classmethod
    def of(cls, graph: CutCellGraph) -> NodeGrid:
        """Return the grid of the nodes of a graph that have edges."""
        if not graph.connected.any():
            raise MeshError("every triangle of the mesh has collapsed into a point")
        return cls(graph.nodes, graph.connected, graph.lattice.resolution)

    def nearest(
        self, points: NDArray[np.float64], apart: NDArray[np.integer] | None = None
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Find the nearest nodes of each point: the eight around the middle of a cell are equal.

        Nodes with the label of a point in `apart` are passed over; there must be others.

        Shapes: points (p, 3), apart (p,); returns point, node (f,).
        """
        apart = np.full(len(points), -1) if apart is None else apart
        labels = apart.astype(np.int32), self._label
        inside, pairs = np.clip(points, 0, 1), np.empty((8 * len(points), 2), np.int64)
        while True:
            count = _nearest(
                points, inside, self._across, self._start, self._points, *labels, pairs
            )
            if count <= len(pairs):
                return pairs[:count, 0], self._number[pairs[:count, 1]]
            pairs = np.empty((count, 2), np.int64)

    def near(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return for each point (p, 3) whether a node is in its lattice cell or next to it."""
        # Points far outside are moved to where they still have no neighbour in the cube.
        key, (x, y) = self._keys(np.clip(points, -1, 2)), np.indices((3, 3)).reshape(2, 9, 1) - 1
        lowest = key + (x * CELLS_ACROSS + y) * CELLS_ACROSS - 1  # of three cells in a row
        following = self._cells[np.searchsorted(self._cells, lowest)]
        return np.asarray((following < lowest + 3).any(axis=0))

    @cached_property
    def _cells(self) -> NDArray[np.int64]:
        """The key of the lattice cell of each node, ascending, and one beyond all."""
        return np.append(np.sort(self._keys(self._points)), np.iinfo(np.int64).max)

    def _keys(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the key of the lattice cell of each point (p, 3)."""
        x, y, z = np.floor((points.T + TIE) * self._resolution).astype(np.int64)
        return (x * CELLS_ACROSS + y) * CELLS_ACROSS + z


@no_refcount
def _nearest(points, inside, across, start, nodes, apart, label, pairs):
    """List each point with its nearest nodes as far as there is room; return how many they are.

    `inside` are the nearest points of the unit cube.
    """
    count = 0
    for p in range(len(points)):
        least, ring = np.inf, 0
        while least == np.inf:  # of the smallest cube of cells around it that holds any node
            least = _least_in(
                _box(inside, p, ring / across, across), points, p, start, nodes, apart[p], label
            )
            ring += 1
        reach = np.sqrt(max(least - _squared(points, p, inside, p), 0.0)) + TIE
        box = _box(inside, p, reach, across)
        limit = _least_in(box, points, p, start, nodes, apart[p], label)
        limit = (np.sqrt(limit) + TIE) ** 2
        (low_x, low_y, low_z), (high_x, high_y, high_z), _ = box
        for x in range(low_x, high_x + 1):
            for y in range(low_y, high_y + 1):
                column = (x * across + y) * across
                for n in range(start[column + low_z], start[column + high_z + 1]):
                    if label[n] != apart[p] and _squared(points, p, nodes, n) <= limit:
                        if count < len(pairs):
                            pairs[count, 0], pairs[count, 1] = p, n
                        count += 1
    return count


@compiled(inline="always")
def _box(inside, p, reach, across):
    """Return the lowest and the highest cell of the box that reaches around a point."""
    x, y, z, last = inside[p, 0], inside[p, 1], inside[p, 2], across - 1
    low_x, high_x = max(int((x - reach) * across), 0), min(int((x + reach) * across), last)
    low_y, high_y = max(int((y - reach) * across), 0), min(int((y + reach) * across), last)
    low_z, high_z = max(int((z - reach) * across), 0), min(int((z + reach) * across), last)
    return (low_x, low_y, low_z), (high_x, high_y, high_z), across


@no_refcount
def _least_in(box, points, p, start, nodes, apart, label):
    """Return the least squared distance of a point to the nodes of a box with other labels."""
    (low_x, low_y, low_z), (high_x, high_y, high_z), across = box
    least = np.inf
    for x in range(low_x, high_x + 1):
        for y in range(low_y, high_y + 1):
            column = (x * across + y) * across
            for n in range(start[column + low_z], start[column + high_z + 1]):
                if label[n] != apart:
                    least = min(least, _squared(points, p, nodes, n))
    return least


@compiled(inline="always")
def _squared(points, p, others, q):
    """Return the squared distance between a point and another one."""
    x, y, z = (
        points[p, 0] - others[q, 0],
        points[p, 1] - others[q, 1],
        points[p, 2] - others[q, 2],
    )
    return x * x + y * y + z * z
