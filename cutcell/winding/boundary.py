"""The boundary chain of a mesh: the edges with signed incidence, as closed loops."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..surface.edges import find_edges


class Boundary(NamedTuple):
    """The boundary chain of a mesh as closed loops; no loops if the mesh is closed.

    Parameters
    ----------
    loop : array, shape (e,), int64
        The vertices of the loops, one loop after the other, in the direction of the faces.
    start : array, shape (l + 1,), int64
        Loop i has the vertices loop[start[i]] to loop[start[i + 1] - 1].
    """

    loop: NDArray[np.int64]
    start: NDArray[np.int64]

    @property
    def following(self) -> NDArray[np.int64]:
        """The vertex after each of `loop`, shape (e,)."""
        following = np.roll(self.loop, -1)
        following[self.start[1:] - 1] = self.loop[self.start[:-1]]
        return following


def find_boundary(faces: NDArray[np.int32]) -> Boundary:
    """Find the boundary of welded faces, shape (m, 3)."""
    edges, incidence, _ = find_edges(faces)
    return boundary_of(edges, incidence)


def boundary_of(edges: NDArray[np.int32], incidence: NDArray[np.int32]) -> Boundary:
    """Assemble the boundary from edges and their signed incidence, see `surface.edges`."""
    is_open = incidence != 0
    if not is_open.any():
        return Boundary(np.empty(0, np.int64), np.zeros(1, np.int64))
    return Boundary(*_loops(edges[is_open], incidence[is_open], int(edges.max()) + 1))


@compiled
def _loops(edges, count, vertices):
    """Decompose the boundary chain into closed loops without repeated vertices.

    The chain enters each vertex as often as it leaves it, so a walk along unused edges never gets
    stuck. Whenever the walk returns to a vertex of its path it has closed a loop, which is removed.
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
    path, slot = np.empty(leaving[-1] + 1, np.int64), np.full(vertices, -1)
    cursor = leaving[:-1].copy()
    for first in range(vertices):
        while cursor[first] < leaving[first + 1]:
            path[0], slot[first], length = first, 0, 1
            while length > 1 or cursor[first] < leaving[first + 1]:
                here = path[length - 1]
                there = following[cursor[here]]
                cursor[here] += 1
                if slot[there] < 0:
                    path[length], slot[there] = there, length
                    length += 1
                    continue
                for k in range(slot[there], length):
                    loop[size] = path[k]
                    size += 1
                    if k > slot[there]:
                        slot[path[k]] = -1
                start.append(size)
                length = slot[there] + 1
            slot[first] = -1
    return loop, np.array(start)
