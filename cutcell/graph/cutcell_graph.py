"""The cut-cell graph itself (paper section 3.1, figure "cut-cell graph")."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .lattice import Lattice

MESH, INTERIOR, SURFACE = 0, 1, 2
"""Kinds of nodes (mesh vertices, lattice points inside, crossings of rays and surface) and
of edges (of the mesh, along rays inside, from a crossing to the corners of its triangle)."""


@dataclass(frozen=True, eq=False)
class CutCellGraph:
    """Mesh, inside pieces of lattice lines and surface points as one graph.

    Positions and lengths are in the unit cube: `lattice` leads back to the file's units.

    Parameters
    ----------
    nodes : array, shape (N, 3), float64
        Welded mesh vertices, then lattice points, then crossings.
    node_kind : array, shape (N,), uint8
        MESH, INTERIOR or SURFACE.
    edges : array, shape (E, 2), int32
        Node indices; each edge once.
    lengths : array, shape (E,), float64
    edge_kind : array, shape (E,), uint8
        MESH, INTERIOR or SURFACE.
    triangle : array, shape (N,), int32
        The face that a surface node lies on; -1 for other nodes.
    vertex_node : array, shape (n,), int32
        The node of each vertex of the mesh as it was given.
    lattice : Lattice
    is_closed : bool
        Whether the faces leave no boundary, so that inside and outside are never in doubt.
    """

    nodes: NDArray[np.float64]
    node_kind: NDArray[np.uint8]
    edges: NDArray[np.int32]
    lengths: NDArray[np.float64]
    edge_kind: NDArray[np.uint8]
    triangle: NDArray[np.int32]
    vertex_node: NDArray[np.int32]
    lattice: Lattice
    is_closed: bool

    def csr(self) -> csr_array:
        """Return the lengths as a symmetric matrix, shape (N, N); zero lengths are stored."""
        return self._matrix

    @cached_property
    def _matrix(self) -> csr_array:
        count = len(self.nodes)
        a, b = self.edges.T
        ends = np.concatenate([a, b]), np.concatenate([b, a])
        lengths = np.concatenate([self.lengths, self.lengths])
        return csr_array((lengths, ends), shape=(count, count))

    @cached_property
    def degree(self) -> NDArray[np.int64]:
        """Number of edges at each node, shape (N,)."""
        return np.bincount(self.edges.ravel(), minlength=len(self.nodes))
