"""The cut-cell graph itself (paper section 3.1, figure "cut-cell graph")."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..threads import meanwhile
from .blocks import find_blocks
from .contracted import Contracted, contract
from .interior import InteriorPoints
from .lattice import Lattice
from .neighbours import Adjacency, list_neighbours

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
    faces : array, shape (m, 3), int32
        The mesh's triangles between nodes, all facing outward as far as can be told; those that
        welding closed up are still there.
    lattice : Lattice
    is_closed : bool
        Whether the faces leave no boundary, so that inside and outside are never in doubt.
    connectivity : {6, 26, "any"}
        How paths may run inside, see `build_graph`.
    interior : InteriorPoints
        The lattice points inside, in the order of their nodes.
    steps : array, shape (p, 6) or (0, 6), int32
        For each interior lattice point those next to it up x, y, z and down x, y, z, if the edge
        between lies inside and is not crossed by the surface; else -1. No rows with connectivity
        6, where nobody asks.
    inverted : array, shape (m,), bool
        Which faces are inside out in the mesh itself, see `inverted_faces`.
    """

    nodes: NDArray[np.float64]
    node_kind: NDArray[np.uint8]
    edges: NDArray[np.int32]
    lengths: NDArray[np.float64]
    edge_kind: NDArray[np.uint8]
    triangle: NDArray[np.int32]
    vertex_node: NDArray[np.int32]
    faces: NDArray[np.int32]
    lattice: Lattice
    is_closed: bool
    connectivity: int | str
    interior: InteriorPoints
    steps: NDArray[np.int32]
    inverted: NDArray[np.bool_]

    @property
    def first_point(self) -> int:
        """The node of the first lattice point."""
        return int(self.vertex_node.max()) + 1

    @property
    def first_crossing(self) -> int:
        """The node of the first crossing."""
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
    def contracted(self) -> Contracted:
        """What is left of it for paths at any angle, see `contract`."""
        return self._contraction()

    def begin_contracting(self) -> None:
        """Let another core find `contracted` while this one does something else."""
        _ = self._contraction

    @cached_property
    def _contraction(self) -> Callable[[], Contracted]:
        # Of its arrays alone: were the graph itself kept, it would keep itself in memory.
        found = self.nodes, self.edges, self.steps, self.lattice.resolution
        return meanwhile(partial(_contract, *found, self.first_point, self.first_crossing))

    @cached_property
    def connected(self) -> NDArray[np.bool_]:
        """Whether any edge ends at each node, shape (N,)."""
        found = np.ones(len(self.nodes), np.bool_)
        found[: self.first_point] = False  # of all nodes those of the mesh alone may have none
        found[self.edges[: np.searchsorted(self.edge_kind, MESH, side="right")]] = True
        return found


def _contract(
    nodes: NDArray[np.float64],
    edges: NDArray[np.int32],
    steps: NDArray[np.int32],
    resolution: int,
    first_point: int,
    first_crossing: int,
) -> Contracted:
    block = find_blocks(nodes[first_point:first_crossing], resolution, steps)
    return contract(nodes, edges, block, first_point)
