"""Neighbours of vertices, over the surface of a mesh or through the body, and smoothing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, dia_array
from scipy.spatial import cKDTree

from ...geometry.welded import WeldedMesh
from ...graph import CutCellGraph
from ...rig import TriangleMesh

SMOOTHING_STEP = 0.5
"""Part of the way to its neighbours that a pass moves a vertex; half of it never oscillates."""


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Links between welded vertices and, through the body, the other nodes of a graph.

    Parameters
    ----------
    welded : array, shape (n,), int32
        The node of each vertex: copies of a vertex at a seam have the same.
    links : csr_array, shape (N, N), float64
        1 for each pair of neighbours; welded vertices are the first nodes.
    """

    welded: NDArray[np.int32]
    links: csr_array

    @classmethod
    def of(cls, mesh: TriangleMesh, within: float = 0.0) -> Neighbours:
        """Link welded vertices along the edges of a mesh, and others within a distance."""
        if not within:
            return cls.along(mesh.welded)
        tree = cKDTree(mesh.vertices[mesh.welded.first])
        return cls.along(mesh.welded, tree.query_pairs(within, output_type="ndarray"))

    @classmethod
    def along(cls, welded: WeldedMesh, pairs: NDArray[np.integer] | None = None) -> Neighbours:
        """Link welded vertices along the edges of a mesh, and further pairs, shape (p, 2)."""
        edges = welded.edges.edges
        links = edges if pairs is None else np.concatenate([edges, pairs])
        return cls(welded.index, _symmetric(links, len(welded.points)))

    @classmethod
    def through(cls, graph: CutCellGraph) -> Neighbours:
        """Link the nodes of a graph: vertices of several shells meet inside the body."""
        return cls(graph.vertex_node, _symmetric(graph.edges, len(graph.nodes)))

    def grown(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Add all neighbours of chosen vertices, shape (n,), and all copies of both."""
        at_node = self._at_nodes(chosen)
        return np.asarray((at_node | (self.links @ at_node > 0))[self.welded])

    def shrunk(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Remove chosen vertices, shape (n,), that have a neighbour which is not chosen."""
        return ~self.grown(~self._at_nodes(chosen)[self.welded])

    def dilated(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the largest value, (n,), 0 or more, of each vertex, its copies and neighbours."""
        most = np.zeros(self.links.shape[0])
        np.maximum.at(most, self.welded, values)
        around = self.links.multiply(most[None]).max(axis=1).toarray().ravel()
        return np.asarray(np.maximum(most, around)[self.welded])

    def smooth(
        self, weights: NDArray[np.float64], steps: int, which: NDArray[np.intp] | None = None
    ) -> NDArray[np.float64]:
        """Return smoothed weights of some vertices (k,), or of all; weights (n, j).

        Only rows from which something flows to the vertices are touched.
        """
        if which is None:
            smoothed = self._mean @ weights
            for _ in range(steps):
                smoothed = self._step @ smoothed
            return np.asarray(smoothed[self.welded])
        around = [np.unique(self.welded[which])]
        for _ in range(steps):
            around.append(np.union1d(self._step[around[-1]].indices, around[-1]))
        nearest = self._mean[around[-1]]
        used = np.unique(nearest.indices)
        around_it = weights[used]
        columns = np.flatnonzero(around_it.any(axis=0))
        smoothed = nearest[:, used] @ around_it[:, columns]
        for inner, outer in zip(around[-2::-1], around[:0:-1], strict=True):
            smoothed = self._step[inner][:, outer] @ smoothed
        rows = np.zeros((len(which), weights.shape[1]))
        rows[:, columns] = smoothed[np.searchsorted(around[0], self.welded[which])]
        return rows

    @cached_property
    def _mean(self) -> csr_array:
        """The mean of the vertices that are welded to one, as a matrix of shape (N, n)."""
        where = self.welded, np.arange(len(self.welded))
        shape = self.links.shape[0], len(self.welded)
        return csr_array((1 / np.bincount(self.welded)[self.welded], where), shape=shape)

    @cached_property
    def _step(self) -> csr_array:
        """A pass as a matrix: half the vertex, half the mean of its neighbours."""
        degree, links = np.diff(self.links.indptr), self.links
        share = np.repeat(SMOOTHING_STEP / np.maximum(degree, 1), degree)
        stays = dia_array(
            (np.where(degree > 0, 1 - SMOOTHING_STEP, 1.0)[None], [0]), shape=links.shape
        )
        return csr_array((share, links.indices, links.indptr), shape=links.shape) + stays.tocsr()

    def _at_nodes(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        at_node = np.zeros(self.links.shape[0], np.bool_)
        at_node[self.welded[chosen]] = True
        return at_node


def _symmetric(pairs: NDArray[np.integer], count: int) -> csr_array:
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    row, column = np.concatenate([pairs, pairs[:, ::-1]]).T
    links = csr_array((np.ones(len(row)), (row, column)), shape=(count, count))
    links.sum_duplicates()
    links.data[:] = 1.0
    return links
