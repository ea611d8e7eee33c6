"""Caps that close the holes of a mesh, so that its winding number is nearly a count of crossings.

With every hole capped, the signed count of crossings is a whole number: the winding number of the
closed surface. The mesh's own number is less by that of the caps, see `cells.py`. Any caps will do.
Here each loop of the boundary chain gets a fan of triangles around its middle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .boundary import Boundary


class Caps(NamedTuple):
    """A fan of triangles for each loop of the boundary.

    Parameters
    ----------
    vertices : array, shape (n + k, 3)
        The mesh's, then the middles of those k loops that have more than four edges.
    faces : array, shape (t, 3), int32
        Of all fans. Together with the mesh's own they make a closed surface.
    loop, start : arrays, shapes (e,) and (l + 1,), int64
        As of the `Boundary`.
    apex : array, shape (l,), int64
        The vertex that the triangles of a fan share: of a short loop its first.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    loop: NDArray[np.int64]
    start: NDArray[np.int64]
    apex: NDArray[np.int64]


def cap_holes(vertices: NDArray[np.float64], boundary: Boundary) -> Caps:
    """Close a mesh of vertices (n, 3) that has this boundary."""
    apex, middles, faces = _fans(vertices, *boundary)
    return Caps(np.concatenate([vertices, middles]), faces, *boundary, apex)


@compiled
def _fans(vertices, loop, start):
    apex, middles = np.empty(len(start) - 1, np.int64), np.zeros((len(start) - 1, 3))
    faces = np.empty((len(loop), 3), np.int32)
    fans = count = 0
    for k in range(len(start) - 1):
        begin, end = start[k], start[k + 1]
        if end - begin <= 4:
            apex[k] = loop[begin]
        else:
            apex[k] = len(vertices) + fans
            for i in range(begin, end):
                for axis in range(3):
                    middles[fans, axis] += vertices[loop[i], axis] / (end - begin)
            fans += 1
        for i in range(begin, end):
            after = loop[i + 1] if i + 1 < end else loop[begin]
            if apex[k] != loop[i] and apex[k] != after:
                # Against the direction of the boundary: the edge must cancel.
                faces[count, 0], faces[count, 1], faces[count, 2] = after, loop[i], apex[k]
                count += 1
    return apex, middles[:fans].copy(), faces[:count].copy()
