"""The boundary chain of a mesh, the edges with signed incidence, as closed loops."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled


class Boundary(NamedTuple):
    """The boundary chain of a mesh as closed loops; no loops if the mesh is closed.

    Parameters
    ----------
    loop : array, shape (e,), int64
        The vertices of the loops, one loop after the other, in the direction of the faces. A loop
        is repeated where faces lie on copies.
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


def boundary_of(edges: NDArray[np.int32], incidence: NDArray[np.int32]) -> Boundary:
    """Assemble the boundary from edges (e, 2) and their signed incidence, see `MeshEdges`."""
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
        leaving[(edges[e, 0] if count[e] > 0 else edges[e, 1]) + 1] += 1
    leaving = np.cumsum(leaving)
    cursor = leaving[:-1].copy()
    following, unused = np.empty(len(edges), np.int64), np.empty(len(edges), np.int64)
    for e in range(len(edges)):
        a, b = (edges[e, 0], edges[e, 1]) if count[e] > 0 else (edges[e, 1], edges[e, 0])
        following[cursor[a]], unused[cursor[a]] = b, abs(count[e])
        cursor[a] += 1

    loop, start = [np.int64(0) for _ in range(0)], [0]
    path, slot = np.empty(vertices + 1, np.int64), np.full(vertices, -1)
    cursor = leaving[:-1].copy()
    for first in range(vertices):
        path[0], slot[first], length = first, 0, 1
        while length > 1 or cursor[first] < leaving[first + 1]:
            vertex = following[cursor[path[length - 1]]]
            if slot[vertex] < 0:
                path[length], slot[vertex] = vertex, length
                length += 1
                continue
            around = path[slot[vertex] : length]
            for a in around:
                loop.append(a)
                unused[cursor[a]] -= 1
                cursor[a] += unused[cursor[a]] == 0
                slot[a] = -1
            start.append(len(loop))
            slot[vertex] = length - len(around)
            length = slot[vertex] + 1
        slot[first] = -1
    return np.array(loop), np.array(start)
