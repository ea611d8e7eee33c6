"""Fewer nodes, and ways as good: which nodes can be passed over, and what stands for them.

Where a ray leaves the body, its last segment runs from a lattice point to a crossing, and from
there edges lead to the corners of a triangle and nowhere else. Shortcuts from the lattice point to
those corners leave out a third of the nodes (in contraction hierarchies, Geisberger, Sanders,
Schultes & Delling 2008, the same is done to road maps). Crossings stay where the body is thinner
than a lattice cell.

Deep inside one lattice point stands for a block of eight, and between two blocks runs one edge in
place of four. Ways along the edges change by that, but those at any angle are straight there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..sorting import sort_into
from .blocks import NO_BLOCK
from .neighbours import count_ends, list_ends

STAYS, NOT_FOUND = -1, -2
CORNERS = 3


@dataclass(frozen=True, eq=False)
class Contracted:
    """The nodes that stay, numbered anew in their order, and which of them stand for the others.

    Parameters
    ----------
    indptr, indices : arrays, shapes (K + 1,) and (2E,), int32
        Neighbours of each.
    places : array, shape (K, 3), float64
        In the unit cube.
    node : array, shape (K,), int32
        Which node of the graph each is. Vertices of the mesh all stay.
    number : array, shape (N,), int32
        Of each node of the graph or, where it is passed over, of what stands for it: a lattice
        point next to a crossing, or of the same block.
    first_crossing : int
        The number of the first crossing.
    """

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    places: NDArray[np.float64]
    node: NDArray[np.int32]
    number: NDArray[np.int32]
    first_crossing: int


def contract(
    nodes: NDArray[np.float64], edges: NDArray[np.int32], block: NDArray[np.int32], mesh: int
) -> Contracted:
    """Pass over all of a block but one, and crossings between a lattice point and corners alone.

    Parameters
    ----------
    nodes : array, shape (N, 3)
        Vertices of the mesh, lattice points, crossings.
    edges : array, shape (E, 2)
        Of a graph; those from crossings to corners come last, in the order of the crossings.
    block : array, shape (p,), int32
        Of each lattice point, see `find_blocks`.
    mesh : int
        How many vertices the mesh has.
    """
    return Contracted(*_contract(nodes, edges, block, mesh))


# A single kernel, so that another thread is asked for Python's lock but once.
@compiled
def _contract(nodes, edges, block, mesh):
    first_crossing = mesh + len(block)
    ends = len(edges) - CORNERS * (len(nodes) - first_crossing)
    stand_in = _find_stand_ins(edges[:ends], block, mesh, len(nodes))
    node, number = _number(stand_in)
    left = np.empty_like(edges)
    count = _leave_out(nodes, edges, block, mesh, stand_in, number, left)
    # What stays is below 0.
    start, order = sort_into(stand_in[first_crossing:] - mesh, len(block))
    count = _add_shortcuts(edges, ends, start, order, mesh, number, left, count)
    indptr, indices = _list_neighbours(left[:count], len(node))
    places, crossing = np.empty((len(node), 3)), 0
    for n in range(len(node)):
        for axis in range(3):
            places[n, axis] = nodes[node[n], axis]
        crossing += node[n] < first_crossing
    return indptr, indices, places, node, number, crossing


@compiled
def _find_stand_ins(edges, block, mesh, count):
    """Return which node stands for each; less than 0 for those that stay."""
    stand_in = np.full(count, NOT_FOUND, np.int32)
    for p in range(len(block)):
        if block[p] != NO_BLOCK and block[p] != p:
            stand_in[mesh + p] = mesh + block[p]
    first_crossing = mesh + len(block)
    for e in range(len(edges)):
        for side in range(2):
            c, other = edges[e, side], edges[e, 1 - side]
            if c >= first_crossing:
                alone = stand_in[c] == NOT_FOUND and mesh <= other < first_crossing
                stand_in[c] = other if alone else STAYS
    return stand_in


@compiled
def _number(stand_in):
    """Return which nodes stay, and the number of each node."""
    node, number = np.empty(len(stand_in), np.int32), np.empty(len(stand_in), np.int32)
    count = 0
    for n in range(len(stand_in)):
        if stand_in[n] < 0:
            node[count], number[n] = n, count
            count += 1
    for n in range(len(stand_in)):
        if stand_in[n] >= 0:
            number[n] = number[stand_in[n]]
    return node[:count].copy(), number


@compiled
def _leave_out(nodes, edges, block, mesh, stand_in, number, left):
    """List the edges between nodes that stay, and one between neighbouring blocks."""
    first_crossing = mesh + len(block)
    count = 0
    for e in range(len(edges)):
        u, v = edges[e, 0], edges[e, 1]
        if max(u, v) >= first_crossing:
            if stand_in[max(u, v)] >= 0:
                continue
        elif min(u, v) >= mesh:
            a, b = block[u - mesh], block[v - mesh]
            between = a != NO_BLOCK and b != NO_BLOCK
            if between and (a == b or not _in_line(nodes, mesh + a, u, v)):
                continue
        left[count, 0], left[count, 1] = number[u], number[v]
        count += 1
    return count


@compiled
def _list_neighbours(edges, count):
    indptr = np.zeros(count + 1, np.int32)
    count_ends(edges, 0, count, indptr[1:])
    for node in range(count):
        indptr[node + 1] += indptr[node]
    indices, no_lengths = np.empty(2 * len(edges), np.int32), np.empty(0)
    list_ends(edges, no_lengths, 0, count, indptr[:-1].copy(), indices, no_lengths)
    return indptr, indices


@compiled(inline="always")
def _in_line(nodes, a, u, v):
    """Tell if a node lies on the line along an axis through two others."""
    for axis in range(3):
        if nodes[u, axis] == nodes[v, axis] and nodes[u, axis] != nodes[a, axis]:
            return False
    return True


@compiled
def _add_shortcuts(edges, ends, start, order, mesh, number, left, count):
    """List shortcuts from lattice points to corners, each once, from `count` on.

    `order` from start[p] on are the crossings that the lattice point p stands for. The edges of the
    first crossing begin at `ends`.
    """
    for p in range(len(start) - 1):
        own = count  # its shortcuts so far begin there
        for c in order[start[p] : start[p + 1]]:
            for e in range(ends + CORNERS * c, ends + CORNERS * c + CORNERS):
                k = own
                while k < count and left[k, 1] != edges[e, 1]:
                    k += 1
                if k == count:
                    left[k, 0], left[k, 1] = number[mesh + p], edges[e, 1]
                    count += 1
    return count
