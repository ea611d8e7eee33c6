"""The edges of a mesh, each once, and how often its faces use them in either direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled, put


def find_edges(faces: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """List the edges of welded faces.

    Parameters
    ----------
    faces : array, shape (m, 3), int32
        Sides whose ends were welded into one are left out.

    Returns
    -------
    edges : array, shape (e, 2), int32
        Lower vertex first, sorted.
    balance : array, shape (e,), int32
        Uses from the lower to the higher vertex less those the other way: zero wherever
        the mesh is closed.
    """
    return _find_edges(faces, int(faces.max()) + 1)


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
    once = np.empty((sides, 3), np.int32)
    for f in range(len(faces)):
        for k in range(3):
            a, b = faces[f, k], faces[f, (k + 1) % 3]
            if a != b:
                place = by_high[max(a, b)]
                once[place, 0], once[place, 1] = min(a, b), max(a, b)
                once[place, 2] = 1 if a < b else -1
                by_high[max(a, b)] += 1
    twice = np.empty((sides, 3), np.int32)
    for s in range(sides):
        low = once[s, 0]
        put(once[s], twice[by_low[low]])
        by_low[low] += 1

    edges, balance = np.empty((sides, 2), np.int32), np.empty(sides, np.int32)
    count = 0
    for s in range(sides):
        a, b = twice[s, 0], twice[s, 1]
        if count and edges[count - 1, 0] == a and edges[count - 1, 1] == b:
            balance[count - 1] += twice[s, 2]
        else:
            edges[count, 0], edges[count, 1], balance[count] = a, b, twice[s, 2]
            count += 1
    return edges[:count].copy(), balance[:count].copy()
