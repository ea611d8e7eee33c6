"""Fewer nodes, and ways as good: which nodes can be passed over, and what stands for them.

Where a ray leaves the body, its last segment runs from a lattice point to a crossing, and from
there edges lead to the corners of a triangle and nowhere else. Shortcuts from the lattice point to
those corners are as long, and a third of the nodes is left out (in contraction hierarchies,
Geisberger, Sanders, Schultes & Delling 2008, the same is done to road maps). Crossings stay where
the body is thinner than a lattice cell.

Deep inside one lattice point stands for a block of eight. Between blocks runs one edge in place of
four. Ways along the edges change by that, but straight ways through the body, which is what
blocks are for, run no other way than before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..sorting import sort_into
from .blocks import NO_BLOCK
from .neighbours import Adjacency, list_neighbours

STAYS = -1
CORNERS = 3


@dataclass(frozen=True, eq=False)
class Contracted:
    """Neighbours where some nodes are passed over; all keep their numbers.

    Parameters
    ----------
    adjacency : Adjacency
        See `list_neighbours`; nodes that are passed over have no neighbours.
    stand_in : array, shape (N,), int32
        The lattice point that stands for each node that is passed over: next to a crossing, or of
        the same block; -1 for nodes that stay.
    """

    adjacency: Adjacency
    stand_in: NDArray[np.int32]


def contract(
    nodes: NDArray[np.float64],
    edges: NDArray[np.int32],
    lengths: NDArray[np.float64],
    block: NDArray[np.int32],
    mesh: int,
    crossings: int,
) -> Contracted:
    """Pass over all of a block but one, and crossings between a lattice point and corners alone.

    Parameters
    ----------
    nodes : array, shape (N, 3)
        Vertices of the mesh, lattice points, crossings.
    edges, lengths : arrays, shapes (E, 2) and (E,)
        Of a graph; those from crossings to corners come last, in the order of the crossings.
    block : array, shape (p,), int32
        Of each lattice point, see `find_blocks`.
    mesh, crossings : int
        How many nodes of each kind there are.
    """
    points, ends = len(block), len(edges) - CORNERS * crossings
    point, leg = _find_legs(edges[:ends], lengths, mesh, points, crossings)
    left, of_left = _leave_out(nodes, edges, lengths, block, mesh, point)
    by_point = sort_into(point - mesh, points)  # what stays has a number below 0
    new, of_new = _shortcuts(edges[ends:], lengths[ends:], mesh, leg, *by_point)
    adjacency = list_neighbours(
        np.concatenate([left, new]), np.concatenate([of_left, of_new]), len(nodes)
    )
    passed = (block != NO_BLOCK) & (block != np.arange(points))
    inner = np.where(passed, block + mesh, STAYS).astype(np.int32)
    return Contracted(adjacency, np.concatenate([np.full(mesh, STAYS, np.int32), inner, point]))


@njit(cache=True, nogil=True)
def _find_legs(edges, lengths, mesh, points, crossings):
    """Find the lattice point beside each crossing that can be passed over, and how far it is."""
    point, leg = np.full(crossings, STAYS, np.int32), np.empty(crossings)
    found = np.zeros(crossings, np.int32)
    first_crossing = mesh + points
    for e in range(len(edges)):
        for side in range(2):
            c, other = edges[e, side] - first_crossing, edges[e, 1 - side]
            if c >= 0:
                found[c] += 1
                alone = found[c] == 1 and mesh <= other < first_crossing
                point[c], leg[c] = other if alone else STAYS, lengths[e]
    return point, leg


@njit(cache=True, nogil=True)
def _leave_out(nodes, edges, lengths, block, mesh, point):
    """List the edges between nodes that stay, and one between neighbouring blocks."""
    first_crossing = mesh + len(block)
    left, of_left = np.empty_like(edges), np.empty_like(lengths)
    count = 0
    for e in range(len(edges)):
        u, v, length = edges[e, 0], edges[e, 1], lengths[e]
        if max(u, v) >= first_crossing:
            if point[max(u, v) - first_crossing] != STAYS:
                continue
        elif min(u, v) >= mesh:
            a, b = block[u - mesh], block[v - mesh]
            between = a != NO_BLOCK and b != NO_BLOCK
            if between and (a == b or not _in_line(nodes, mesh + a, u, v)):
                continue
            if a != NO_BLOCK or b != NO_BLOCK:
                u, v = mesh + a if a != NO_BLOCK else u, mesh + b if b != NO_BLOCK else v
                length = _straight(nodes, u, v)
        left[count, 0], left[count, 1], of_left[count] = u, v, length
        count += 1
    return left[:count], of_left[:count]


@njit(cache=True, inline="always")
def _in_line(nodes, a, u, v):
    """Tell if a node lies on the line along an axis through two others."""
    for axis in range(3):
        if nodes[u, axis] == nodes[v, axis] and nodes[u, axis] != nodes[a, axis]:
            return False
    return True


@njit(cache=True, inline="always")
def _straight(nodes, u, v):
    x, y, z = nodes[u, 0] - nodes[v, 0], nodes[u, 1] - nodes[v, 1], nodes[u, 2] - nodes[v, 2]
    return np.sqrt(x * x + y * y + z * z)


@njit(cache=True, nogil=True)
def _shortcuts(edges, lengths, mesh, leg, start, order):
    """List shortcuts from lattice points to corners, each once; `edges` are those to corners."""
    new, of_new = np.empty((CORNERS * len(order), 2), np.int32), np.empty(CORNERS * len(order))
    count = 0
    for p in range(len(start) - 1):
        own = count  # its shortcuts so far begin there
        for c in order[start[p] : start[p + 1]]:
            for e in range(CORNERS * c, CORNERS * c + CORNERS):
                corner, length = edges[e, 1], leg[c] + lengths[e]
                k = own
                while k < count and new[k, 1] != corner:
                    k += 1
                if k == count:
                    new[k, 0], new[k, 1], of_new[k] = mesh + p, corner, length
                    count += 1
                of_new[k] = min(of_new[k], length)
    return new[:count], of_new[:count]
