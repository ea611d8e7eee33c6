"""The boundary of a mesh: loops of edges that its faces leave open."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .mesh_edges import find_edges


class Boundary(NamedTuple):
    """The boundary chain of a mesh, cut into loops; no loops if it is closed.

    Parameters
    ----------
    loop : array, shape (e,), int64
        The vertices of the loops, one loop after the other, as the mesh's faces run.
    start : array, shape (l + 1,), int64
        Loop i has the vertices loop[start[i]] to loop[start[i + 1] - 1].
    """

    loop: NDArray[np.int64]
    start: NDArray[np.int64]

    @property
    def following(self) -> NDArray[np.int64]:
        """The vertex after each of `loop`, shape (e,)."""
        after = np.roll(self.loop, -1)
        after[self.start[1:] - 1] = self.loop[self.start[:-1]]
        return after


def find_boundary(faces: NDArray[np.int32]) -> Boundary:
    """Find the boundary of welded faces, shape (m, 3)."""
    edges, balance, _ = find_edges(faces)
    return boundary_of(edges, balance)


def boundary_of(edges: NDArray[np.int32], balance: NDArray[np.int32]) -> Boundary:
    """Pick the boundary from all edges of a mesh, see `mesh_edges.find_edges`."""
    is_open = balance != 0
    if not is_open.any():
        return Boundary(np.empty(0, np.int64), np.zeros(1, np.int64))
    return Boundary(*_loops(edges[is_open], balance[is_open], int(edges.max()) + 1))


@compiled
def _loops(edges, count, vertices):
    """Cut the boundary chain into closed loops without repeated vertices.

    The chain enters each vertex as often as it leaves it, so a walk along it never gets
    stuck. Wherever the walk comes back to a vertex it has closed a loop, which is cut off.
    """
    leaving = np.zeros(vertices + 1, np.int64)
    for e in range(len(edges)):
        leaving[(edges[e, 0] if count[e] > 0 else edges[e, 1]) + 1] += abs(count[e])
    leaving = np.cumsum(leaving)
    cursor, following = leaving[:-1].copy(), np.empty(leaving[-1], np.int64)
    for e in range(len(edges)):
        a, b = (edges[e, 0], edges[e, 1]) if count[e] > 0 else (edges[e, 1], edges[e, 0])
        for _ in range(abs(count[e])):
            following[cursor[a]] = b
            cursor[a] += 1

    loop, start = np.empty(leaving[-1], np.int64), [0]
    size = 0
    path, place = np.empty(leaving[-1] + 1, np.int64), np.full(vertices, -1)
    cursor = leaving[:-1].copy()
    for first in range(vertices):
        while cursor[first] < leaving[first + 1]:
            path[0], place[first], length = first, 0, 1
            while length > 1 or cursor[first] < leaving[first + 1]:
                here = path[length - 1]
                there = following[cursor[here]]
                cursor[here] += 1
                if place[there] < 0:
                    path[length], place[there] = there, length
                    length += 1
                    continue
                for k in range(place[there], length):
                    loop[size] = path[k]
                    size += 1
                    if k > place[there]:
                        place[path[k]] = -1
                start.append(size)
                length = place[there] + 1
            place[first] = -1
    return loop, np.array(start)
