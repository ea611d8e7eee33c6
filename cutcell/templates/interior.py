"""The inside of a body: how deep it is, how far its ends are from each other, where limbs run."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from ..graph.cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph

MIN_DEPTH = 0.5
"""Depth of surface nodes, in lattice cells, so that paths have a cost."""
AT_SKIN = 0.1
"""Distance from the skin within which points are treated as outside, in lattice cells."""
LARGE_COMPONENTS = 32
"""Components that others may be joined to; further ones are small."""
MIN_EDGE = 1e-9
"""Least length of edges in the unit cube: one of length 0 would be none."""


class Interior:
    """The connected nodes of a graph in the body's frame: x left, y up, z to the front.

    The frame's axes, rows of (3, 3), and its origin are in the unit cube.
    """

    def __init__(
        self, graph: CutCellGraph, axes: NDArray[np.float64], origin: NDArray[np.float64]
    ) -> None:
        self.graph, self.axes, self.origin = graph, axes, origin
        self.cell = 1 / graph.lattice.resolution
        connected = np.flatnonzero(np.diff(graph.csr().indptr) > 0)
        in_cube = graph.nodes[connected]
        self.points = np.asarray((in_cube - origin) @ axes.T)
        self._lengths = _bridged(csr_array(graph.csr()[connected][:, connected]), self.points)
        kind = graph.node_kind[connected]
        # In the unit cube, where it lies along the lattice: a tree of that is quicker to search.
        self._skin = cKDTree(in_cube[kind == (SURFACE if (kind == SURFACE).any() else MESH)])
        # Mesh vertices are skin wherever they are: a cape has no other nodes.
        self.depth = np.where(kind == INTERIOR, self._skin.query(in_cube)[0], 0.0)
        self._distances: dict[int, NDArray[np.float64]] = {}

    def to_file(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Bring points (..., 3) from the frame into the file's units."""
        return self.graph.lattice.to_file(points @ self.axes + self.origin)

    @cached_property
    def height(self) -> float:
        """From the lowest to the highest point."""
        return float(np.ptp(self.points[:, 1]))

    @cached_property
    def floor(self) -> float:
        """The lowest y."""
        return float(self.points[:, 1].min())

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.points)

    def nearest(self, point: NDArray[np.float64]) -> int:
        """Return the node nearest to a point."""
        return int(self._tree.query(point)[1])

    def deepest(self, among: NDArray[np.bool_]) -> int:
        """Return the deepest of some nodes."""
        chosen = np.flatnonzero(among)
        return int(chosen[self.depth[chosen].argmax()])

    def central(self, among: NDArray[np.bool_]) -> int:
        """Return the one of some nodes that is nearest to their mean."""
        chosen = np.flatnonzero(among)
        away = self.points[chosen] - self.points[chosen].mean(axis=0)
        return int(chosen[np.linalg.norm(away, axis=1).argmin()])

    def distances(self, node: int) -> NDArray[np.float64]:
        """Return the lengths of the shortest paths through the body from a node to all."""
        if node not in self._distances:
            self._distances[node] = np.asarray(dijkstra(self._lengths, indices=node))
        return self._distances[node]

    def branch(self, tip: int, a: int, b: int) -> float:
        """Return how far from a tip the paths to two others part, as in a tree (Gromov product)."""
        far = self.distances(tip)
        return float((far[a] + far[b] - self.distances(a)[b]) / 2)

    def middle_path(self, start: int, end: int) -> NDArray[np.float64]:
        """Return points (k, 3) of a path through the middle of the body between two nodes.

        Edges are the dearer the nearer they are to the surface.
        """
        before = dijkstra(self._costs, indices=end, return_predecessors=True)[1]
        path = [start]
        while path[-1] != end:
            path.append(int(before[path[-1]]))
        return _smooth(self.points[path])

    @cached_property
    def _costs(self) -> csr_array:
        rows = np.repeat(np.arange(len(self.points)), np.diff(self._lengths.indptr))
        columns = self._lengths.indices
        deep = (self.depth[rows] + self.depth[columns]) / 2 + MIN_DEPTH * self.cell
        costs = self._lengths.data / deep**2
        return csr_array((costs, columns, self._lengths.indptr), shape=self._lengths.shape)

    def inward(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points (k, 3) with those that are not inside moved to a deep node nearby."""
        in_cube = points @ self.axes + self.origin
        inside = self.graph.winding_numbers.at(in_cube) >= self.graph.winding_threshold
        inside &= self._skin.query(in_cube)[0] > AT_SKIN * self.cell
        moved = points.copy()
        deep = np.flatnonzero(self.depth > 0)
        for k in np.flatnonzero(~inside):
            far = np.linalg.norm(self.points[deep] - points[k], axis=1)
            moved[k] = self.points[deep[(far - self.depth[deep]).argmin()]]
        return moved


def along(path: NDArray[np.float64], shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of a path (k, 3) at shares (s,) of its length."""
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    where = np.asarray(shares) * at[-1]
    return np.stack([np.interp(where, at, path[:, k]) for k in range(3)], axis=-1)


def cut(body: Interior, tip: int, end: int, far: float) -> NDArray[np.float64]:
    """Return the middle path from a tip to an end as far as it is less than so far from the tip."""
    path = body.middle_path(tip, end)
    at = np.array([body.distances(tip)[body.nearest(point)] for point in path])
    beyond = np.flatnonzero(at >= far)
    return path[: max(int(beyond[0]) + 1, 2)] if len(beyond) else path


def _smooth(path: NDArray[np.float64]) -> NDArray[np.float64]:
    """Take the steps of the lattice out of a path; its ends stay."""
    for _ in range(3):
        if len(path) > 2:
            path[1:-1] = (path[:-2] + 2 * path[1:-1] + path[2:]) / 4
    return path


def _bridged(lengths: csr_array, points: NDArray[np.float64]) -> csr_array:
    """Join the components of a graph where they come nearest, largest first."""
    count, label = connected_components(lengths, directed=False)
    order = np.argsort(-np.bincount(label, minlength=count), kind="stable")
    joined = np.flatnonzero(label == order[0])
    tree = cKDTree(points[joined])
    rows, columns, added = [], [], []
    for rank, one in enumerate(order[1:]):
        members = np.flatnonzero(label == one)
        far, near = tree.query(points[members])
        best = int(far.argmin())
        rows.append(members[best])
        columns.append(joined[near[best]])
        added.append(float(far[best]))
        if rank < LARGE_COMPONENTS:
            joined = np.concatenate([joined, members])
            tree = cKDTree(points[joined])
    bridges = coo_array((added, (rows, columns)), shape=lengths.shape)
    every = csr_array(lengths + bridges + bridges.T)
    every.data = np.maximum(every.data, MIN_EDGE)
    return every
