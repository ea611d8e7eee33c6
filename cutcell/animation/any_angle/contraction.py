"""Graph contraction: fewer nodes for any-angle paths, with paths as short.

Where a ray leaves the body, its last segment runs from a lattice point to a surface node, whose
only other neighbours are the corners of a triangle. Shortcut edges from the lattice point to these
corners replace the surface node, which removes a third of all nodes (as contraction hierarchies do
on road networks: Geisberger, Sanders, Schultes & Delling 2008). Surface nodes stay where the body
is thinner than a lattice cell.

Deep inside, one lattice point represents a block of 2 x 2 x 2, and one edge between two blocks
replaces four. This changes paths along edges, but any-angle paths are straight there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.edges import list_neighbours
from ...geometry.sorting import sort_by_group, spatial_order
from ...graph import INTERIOR, SURFACE, CutCellGraph
from ...graph.inside_edges import lattice_steps
from ...graph.interior import OUTSIDE
from ...runtime.compiled import compiled

UNCONTRACTED, UNKNOWN = -1, -2
"""Instead of a representative: of nodes that are not contracted, or not yet known to be."""
CORNERS = 3
NO_BLOCK = -1
MANY_VERTICES = 50_000
"""With more vertices, wavefronts take half as long if these are numbered by place."""


@dataclass(frozen=True, eq=False)
class Contraction:
    """Numbers of the kept nodes, and the representatives of contracted ones.

    Numbers follow the order of the graph's nodes, except that of many mesh vertices those in one
    lattice cell come one after the other.

    Parameters
    ----------
    steps : array, shape (p, 6), int32
        Neighbours of the lattice points inside, see `lattice_steps`.
    indptr, indices : arrays, shapes (K + 1,) and (2E,), int32
        Neighbours of each kept node.
    places : array, shape (K, 3), float64
        In the unit cube.
    node : array, shape (K,), int32
        The graph's node. All vertices of the mesh are kept.
    number : array, shape (N,), int32
        For each node of the graph its own number, or that of its representative: a lattice point
        next to a surface node, or of the same block.
    first_surface : int
        The number of the first surface node.
    """

    steps: NDArray[np.int32]
    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    places: NDArray[np.float64]
    node: NDArray[np.int32]
    number: NDArray[np.int32]
    first_surface: int

    def representative(self, nodes: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return the representatives of nodes of the graph; of kept nodes themselves."""
        return self.node[self.number[nodes]]


def contract(graph: CutCellGraph) -> Contraction:
    """Contract blocks of lattice points, and surface nodes at the end of a single segment."""
    first, last = graph.first_point, graph.first_surface
    inside = np.searchsorted(graph.edge_kind, np.array([INTERIOR, SURFACE], np.uint8))
    steps = lattice_steps(graph.nodes, graph.edges[slice(*inside)], first, last)
    block = find_blocks(graph.nodes[first:last], graph.lattice.resolution, steps)
    contracted = Contraction(steps, *_contract(graph.nodes, graph.edges, block, first))
    return _sorted_by_place(contracted, first) if first > MANY_VERTICES else contracted


def _sorted_by_place(contracted: Contraction, vertices: int) -> Contraction:
    """Renumber mesh vertices by place. Paths remain the same."""
    order = np.arange(len(contracted.node))
    order[:vertices] = spatial_order(contracted.places[:vertices])
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order))
    size = np.diff(contracted.indptr)[order]
    indptr = np.concatenate([[0], np.cumsum(size)]).astype(np.int32)
    entry = np.arange(indptr[-1]) + np.repeat(contracted.indptr[order] - indptr[:-1], size)
    return replace(
        contracted,
        indptr=indptr,
        indices=rank[contracted.indices[entry]],
        places=contracted.places[order],
        node=contracted.node[order],
        number=rank[contracted.number],
    )


def find_blocks(
    places: NDArray[np.float64], resolution: int, steps: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Find blocks of two lattice points each way whose neighbours are all inside.

    They are laid out from the middle of the cube, alike on both sides, so that a mirror-symmetric
    body gets mirror-symmetric blocks.

    Shapes: places (p, 3), steps (p, 6); returns (p,).
    """
    # Column by column: numpy takes several times as long over many short rows.
    deep = np.all([column != OUTSIDE for column in steps.T], axis=0)
    cell = (places.T * resolution).astype(np.int32)
    upper = 2 * cell >= resolution
    from_middle = np.where(upper, cell - (resolution + 1) // 2, resolution // 2 - 1 - cell)
    innermost = np.flatnonzero(deep & (from_middle % 2 == 0).all(axis=0))
    outward = np.where(upper[:, innermost].T, [0, 1, 2], [3, 4, 5])  # columns of `steps`
    points: list[NDArray[Any]] = [innermost]
    for axis in range(3):  # where a neighbour is outside, the point itself is not deep
        points += [steps[point, outward[:, axis]] for point in points]
    is_block = np.all([deep[point] for point in points], axis=0)
    block = np.full(len(places), NO_BLOCK, np.int32)
    for point in points:
        block[point[is_block]] = innermost[is_block]
    return block


def _contract(
    nodes: NDArray[np.float64], edges: NDArray[np.int32], block: NDArray[np.int32], mesh: int
) -> tuple[Any, ...]:
    """Contract a graph with `mesh` mesh vertices; edges of surface nodes to corners come last."""
    first_surface = mesh + len(block)
    ends = len(edges) - CORNERS * (len(nodes) - first_surface)
    representative = _find_representatives(edges[:ends], block, mesh, len(nodes))
    node = np.flatnonzero(representative < 0).astype(np.int32)
    number = np.empty(len(nodes), np.int32)
    number[node] = np.arange(len(node))
    contracted = np.flatnonzero(representative >= 0)
    number[contracted] = number[representative[contracted]]
    contracted_edges = np.empty_like(edges)
    count = _keep_edges(nodes, edges, block, mesh, representative, number, contracted_edges)
    # Uncontracted nodes are below 0, and left out.
    start, order = sort_by_group(representative[first_surface:] - mesh, len(block))
    count = _add_shortcuts(edges, ends, start, order, mesh, number, contracted_edges, count)
    indptr, indices, _ = list_neighbours(contracted_edges[:count], np.empty(0), len(node))
    return indptr, indices, nodes[node], node, number, int(np.searchsorted(node, first_surface))


def _find_representatives(
    edges: NDArray[np.int32], block: NDArray[np.int32], mesh: int, count: int
) -> NDArray[np.int32]:
    """Return the representative of each contracted node; less than 0 for others."""
    representative = np.full(count, UNKNOWN, np.int32)
    in_block = np.flatnonzero((block != NO_BLOCK) & (block != np.arange(len(block))))
    representative[mesh + in_block] = mesh + block[in_block]
    first_surface = mesh + len(block)
    crossing, other = np.concatenate(
        [edges[edges[:, side] >= first_surface][:, [side, 1 - side]] for side in range(2)]
    ).T
    single = np.bincount(crossing)[crossing] == 1
    single &= (other >= mesh) & (other < first_surface)
    representative[crossing] = np.where(single, other, UNCONTRACTED)
    return representative


@compiled
def _keep_edges(nodes, edges, block, mesh, representative, number, contracted_edges):
    """List the edges between uncontracted nodes, and one edge between neighbouring blocks."""
    first_surface = mesh + len(block)
    count = 0
    for e in range(len(edges)):
        u, v = edges[e, 0], edges[e, 1]
        if max(u, v) >= first_surface:
            if representative[max(u, v)] >= 0:
                continue
        elif min(u, v) >= mesh:
            a, b = block[u - mesh], block[v - mesh]
            between = a != NO_BLOCK and b != NO_BLOCK
            if between and (a == b or not _in_line(nodes, mesh + a, u, v)):
                continue
        contracted_edges[count, 0], contracted_edges[count, 1] = number[u], number[v]
        count += 1
    return count


@compiled(inline="always")
def _in_line(nodes, a, u, v):
    """Return whether a node lies on the axis-parallel line through two others."""
    for axis in range(3):
        if nodes[u, axis] == nodes[v, axis] and nodes[u, axis] != nodes[a, axis]:
            return False
    return True


@compiled
def _add_shortcuts(edges, ends, start, order, mesh, number, contracted_edges, count):
    """List shortcuts from lattice points to corners, each once, from row `count` on.

    `order` from start[p] on are the surface nodes that the lattice point p represents. Edges of
    surface nodes to corners begin at `ends`.
    """
    for p in range(len(start) - 1):
        first = count  # the first of its shortcuts
        for c in order[start[p] : start[p + 1]]:
            for e in range(ends + CORNERS * c, ends + CORNERS * c + CORNERS):
                k = first
                while k < count and contracted_edges[k, 1] != edges[e, 1]:
                    k += 1
                if k == count:
                    contracted_edges[k, 0], contracted_edges[k, 1] = number[mesh + p], edges[e, 1]
                    count += 1
    return count
