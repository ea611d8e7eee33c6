"""The cut-cell graph itself (paper section 3.1, figure "cut-cell graph")."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..geometry.edges import Adjacency, list_neighbours
from ..geometry.welded import WeldedMesh
from ..runtime.repr import Summarized
from .fingerprint import Fingerprint
from .interior import InteriorPoints
from .lattice import Lattice

MESH, INTERIOR, SURFACE = 0, 1, 2
"""Kinds of nodes (mesh vertices, lattice points inside, ray hits on the surface) and of edges (of
the mesh, along rays inside, from a ray hit to the corners of its triangle)."""


@dataclass(frozen=True, eq=False, repr=False)
class CutCellGraph(Summarized):
    """Mesh edges, kept ray segments and their ends on the surface as one graph.

    Positions and lengths are in the unit cube; `lattice` maps them back to the file's units.

    Parameters
    ----------
    nodes : array, shape (N, 3), float64
        Welded mesh vertices, then lattice points, then surface nodes: hits at the ends of kept
        segments.
    node_kind : array, shape (N,), uint8
        MESH, INTERIOR or SURFACE.
    edges : array, shape (E, 2), int32
        Node indices; each edge once.
    lengths : array, shape (E,), float64
    edge_kind : array, shape (E,), uint8
        MESH, INTERIOR or SURFACE.
    triangle : array, shape (N,), int32
        The face that a surface node lies on; -1 for other nodes.
    mesh : WeldedMesh
        Its points are the first nodes. Faces are flipped to face outward where inverted; those left
        out have collapsed.
    lattice : Lattice
    connectivity : {6, 26, "any"}
        See `build_graph`.
    interior : InteriorPoints
        The lattice points inside, in the order of their nodes.
    inverted : array, shape (m,), bool
        Which faces of the mesh are inside out, see `inverted_faces`.
    omitted : array, shape (m,), uint8
        Which faces of the mesh are left out: 1 the reverse side of another face; 2 the wall of a
        void, whose vertices have the nodes of the skin over them. 0 for all others.
    winding_threshold : float
        tau: what has at least this winding number is inside.

    Attributes
    ----------
    fingerprint : mapping
        Of the mesh and the options that it was built from; empty in a copy by `replace`.
    """

    nodes: NDArray[np.float64]
    node_kind: NDArray[np.uint8]
    edges: NDArray[np.int32]
    lengths: NDArray[np.float64]
    edge_kind: NDArray[np.uint8]
    triangle: NDArray[np.int32]
    mesh: WeldedMesh
    lattice: Lattice
    connectivity: int | str
    interior: InteriorPoints
    inverted: NDArray[np.bool_]
    omitted: NDArray[np.uint8]
    winding_threshold: float = 0.5
    fingerprint: Fingerprint = field(init=False, default_factory=dict)

    @property
    def _summary(self) -> dict[str, Any]:
        return {
            "nodes": len(self.nodes),
            "interior_nodes": len(self.interior),
            "surface_nodes": len(self.nodes) - self.first_surface,
            "edges": len(self.edges),
            "resolution": self.lattice.resolution,
            "connectivity": self.connectivity,
            "winding_threshold": self.winding_threshold,
            "is_closed": self.is_closed,
        }

    @property
    def vertex_node(self) -> NDArray[np.int32]:
        """The node of each vertex of the mesh as given, shape (n,): its welded vertex."""
        return self.mesh.index

    @property
    def faces(self) -> NDArray[np.int32]:
        """The faces of `mesh`, shape (m, 3)."""
        return self.mesh.faces

    @property
    def is_closed(self) -> bool:
        """Whether the faces have no boundary."""
        return self.mesh.is_closed

    @property
    def first_point(self) -> int:
        """The node of the first lattice point."""
        return len(self.mesh.points)

    @property
    def first_surface(self) -> int:
        """The first surface node."""
        return self.first_point + len(self.interior)

    def csr(self) -> csr_array:
        """Return the lengths as a symmetric matrix, shape (N, N); zero lengths are stored."""
        indptr, indices, lengths = self.adjacency
        return csr_array((lengths, indices, indptr), shape=(len(self.nodes),) * 2)

    @cached_property
    def adjacency(self) -> Adjacency:
        """Neighbours of each node, see `list_neighbours`."""
        return list_neighbours(self.edges, self.lengths, len(self.nodes))

    @cached_property
    def connected(self) -> NDArray[np.bool_]:
        """Whether any edge ends at each node, shape (N,)."""
        is_connected = np.ones(len(self.nodes), np.bool_)
        is_connected[: self.first_point] = False  # only mesh vertices may be without edges
        is_connected[self.edges[: np.searchsorted(self.edge_kind, MESH, side="right")]] = True
        return is_connected
