"""The same ways between fewer nodes: most crossings can be passed over.

Where a ray leaves the body, its last segment runs from a lattice point to a crossing, and from
there edges lead to the corners of a triangle and nowhere else. Shortcuts from the lattice point to
those corners are as long, and a third of the nodes is left out (in contraction hierarchies,
Geisberger, Sanders, Schultes & Delling 2008, the same is done to road maps). Crossings stay where
the body is thinner than a lattice cell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..sorting import sort_into
from .neighbours import Adjacency, list_neighbours

STAYS = -1
CORNERS = 3


@dataclass(frozen=True, eq=False)
class Contracted:
    """Neighbours where some crossings are passed over; all nodes keep their numbers.

    Parameters
    ----------
    adjacency : Adjacency
        See `list_neighbours`; nodes that are passed over have no neighbours.
    beside : array, shape (N,), int32
        The lattice point next to each node that is passed over; -1 for the others.
    """

    adjacency: Adjacency
    beside: NDArray[np.int32]


def contract(
    edges: NDArray[np.int32], lengths: NDArray[np.float64], mesh: int, points: int, crossings: int
) -> Contracted:
    """Pass over crossings next to one lattice point and the corners of a triangle alone.

    Parameters
    ----------
    edges, lengths : arrays, shapes (E, 2) and (E,)
        Of a graph; those from crossings to corners come last, in the order of the crossings.
    mesh, points, crossings : int
        How many nodes of each kind there are, in this order.
    """
    ends = len(edges) - CORNERS * crossings
    legs = _find_legs(edges[:ends], lengths, mesh, points, crossings)
    point = legs[0]
    by_point = sort_into(point - mesh, points)  # what stays has a number below 0
    kept, of_kept = _shorten(edges, lengths, ends, mesh, *legs, *by_point)
    before = np.full(mesh + points, STAYS, np.int32)
    adjacency = list_neighbours(kept, of_kept, mesh + points + crossings)
    return Contracted(adjacency, np.concatenate([before, point]))


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
def _shorten(edges, lengths, ends, mesh, point, leg, start, order):
    """List the edges that are left, and shortcuts in place of the others."""
    first_crossing = mesh + len(start) - 1
    kept, of_kept = np.empty_like(edges), np.empty_like(lengths)
    count = 0
    for e in range(len(edges)):
        c = max(edges[e, 0], edges[e, 1]) - first_crossing
        if c < 0 or point[c] == STAYS:
            kept[count, 0], kept[count, 1], of_kept[count] = edges[e, 0], edges[e, 1], lengths[e]
            count += 1
    for p in range(len(start) - 1):
        own = count  # its shortcuts so far begin there
        for c in order[start[p] : start[p + 1]]:
            for e in range(ends + CORNERS * c, ends + CORNERS * c + CORNERS):
                corner, length = edges[e, 1], leg[c] + lengths[e]
                k = own
                while k < count and kept[k, 1] != corner:
                    k += 1
                if k == count:
                    kept[k, 0], kept[k, 1], of_kept[k] = mesh + p, corner, length
                    count += 1
                of_kept[k] = min(of_kept[k], length)
    return kept[:count], of_kept[:count]
