"""The edges of a mesh, each once, how often its faces use them, and which faces share them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled, put

NONE = -1


class MeshEdges(NamedTuple):
    """The edges of welded faces.

    Parameters
    ----------
    edges : array, shape (e, 2), int32
        Lower vertex first, sorted.
    balance : array, shape (e,), int32
        Uses from the lower to the higher vertex less those the other way: zero wherever
        the mesh is closed.
    partner : array, shape (3 m,), int32
        For side k of face f, from its corner k to the next, at 3 f + k: the side of another face
        on the same edge if these two alone share it (a manifold edge), else -1. Faces with a
        repeated corner have no partners, and are none.
    """

    edges: NDArray[np.int32]
    balance: NDArray[np.int32]
    partner: NDArray[np.int32]


def find_edges(faces: NDArray[np.int32]) -> MeshEdges:
    """List the edges of welded faces, shape (m, 3); sides with equal ends are left out."""
    return MeshEdges(*_find_edges(faces, int(faces.max()) + 1))


@compiled
def _find_edges(faces, vertices):
    # Two counting sorts: the sides by their higher vertex, then, stable, by their lower.
    by_high = np.zeros(vertices + 1, np.int32)
    by_low = np.zeros(vertices + 1, np.int32)
    for f in range(len(faces)):
        for k in range(3):
            a, b = faces[f, k], faces[f, (k + 1) % 3]
            if a != b:
                by_high[max(a, b) + 1] += 1
                by_low[min(a, b) + 1] += 1
    for v in range(vertices):
        by_high[v + 1] += by_high[v]
        by_low[v + 1] += by_low[v]
    sides = by_low[vertices]
    once = np.empty((sides, 3), np.int32)  # lower and higher vertex, side
    for f in range(len(faces)):
        for k in range(3):
            a, b = faces[f, k], faces[f, (k + 1) % 3]
            if a != b:
                place = by_high[max(a, b)]
                once[place, 0], once[place, 1] = min(a, b), max(a, b)
                once[place, 2] = 3 * f + k if a < b else ~(3 * f + k)
                by_high[max(a, b)] += 1
    twice = np.empty((sides, 3), np.int32)
    for s in range(sides):
        low = once[s, 0]
        put(once[s], twice[by_low[low]])
        by_low[low] += 1

    edges, balance = np.empty((sides, 2), np.int32), np.empty(sides, np.int32)
    partner = np.full(3 * len(faces), NONE, np.int32)
    count, first = 0, 0
    for s in range(sides):
        a, b, side = twice[s]
        if count == 0 or edges[count - 1, 0] != a or edges[count - 1, 1] != b:
            if s - first == 2:
                _pair(twice[first, 2], twice[first + 1, 2], partner)
            edges[count, 0], edges[count, 1], balance[count] = a, b, 0
            count, first = count + 1, s
        balance[count - 1] += 1 if side >= 0 else -1
    if sides - first == 2:
        _pair(twice[first, 2], twice[first + 1, 2], partner)
    return edges[:count].copy(), balance[:count].copy(), partner


@compiled(inline="always")
def _pair(one, other, partner):
    one, other = max(one, ~one), max(other, ~other)
    if one // 3 != other // 3:
        partner[one], partner[other] = other, one
