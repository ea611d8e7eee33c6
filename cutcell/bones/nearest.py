"""Nearest nodes of points, and nodes in the lattice cells around them."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..errors import MeshError
from ..geometry.vectors import TIE
from ..graph import CutCellGraph

NODES_A_LEAF = 32
"""There are a few hundred points and many nodes, so that a shallow tree takes the least time."""
CELLS_ACROSS = 2**13
"""Cells along each axis that have keys of their own: points lie at most the cube beside it."""


class NodeTree:
    """Nodes in a k-d tree.

    Parameters
    ----------
    nodes : array, shape (N, 3)
        In the unit cube.
    chosen : array, shape (N,), bool
        Which of them may be found.
    resolution : int
        R, of the lattice that the nodes are of.
    """

    def __init__(
        self, nodes: NDArray[np.float64], chosen: NDArray[np.bool_], resolution: int
    ) -> None:
        self._number, self._resolution = np.flatnonzero(chosen), resolution
        self._points = nodes[self._number]
        self._tree = cKDTree(self._points, NODES_A_LEAF, compact_nodes=False, balanced_tree=False)

    @classmethod
    def of(cls, graph: CutCellGraph) -> NodeTree:
        """Return the tree of the nodes of a graph that have edges."""
        if not graph.connected.any():
            raise MeshError("every triangle of the mesh has collapsed into a point")
        return cls(graph.nodes, graph.connected, graph.lattice.resolution)

    def nearest(self, points: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Find the nearest nodes of each point: the eight around the middle of a cell are equal.

        Shapes: points (p, 3); returns point, node (f,).
        """
        distance, _ = self._tree.query(points)
        nearest = self._tree.query_ball_point(points, distance + TIE, return_sorted=True)
        point = np.repeat(np.arange(len(points)), [len(nodes) for nodes in nearest])
        return point, self._number[[node for nodes in nearest for node in nodes]]

    def near(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return for each point (p, 3) whether a node is in its lattice cell or next to it."""
        # Points far outside are moved to where they still have no neighbour in the cube.
        key, is_near = self._keys(np.clip(points, -1, 2)), np.zeros(len(points), np.bool_)
        for x, y in np.ndindex(3, 3):
            # Three cells in a row have consecutive keys.
            low = key + ((x - 1) * CELLS_ACROSS + y - 1) * CELLS_ACROSS - 1
            first, last = np.searchsorted(self._cells, [low, low + 3])
            is_near |= first < last
        return is_near

    @cached_property
    def _cells(self) -> NDArray[np.int64]:
        """The key of the lattice cell of each node, ascending."""
        return np.sort(self._keys(self._points))

    def _keys(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the key of the lattice cell of each point (p, 3)."""
        x, y, z = np.floor((points.T + TIE) * self._resolution).astype(np.int64)
        return (x * CELLS_ACROSS + y) * CELLS_ACROSS + z
