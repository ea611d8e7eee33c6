"""Hits of lines along an axis on triangles: the one intersector, with one rule for ties.

A line of the first coordinate u = const meets two edges of a triangle seen along the axis, or none,
and the line along the axis at height v hits the triangle if v lies between these two. The height of
an edge is always computed from its left end, so the two triangles that share the edge get the same
number to the last bit. Whatever rounding does, a line therefore leaves a closed surface as often as
it enters it.

Lines exactly through an edge or a vertex are treated by symbolic perturbation: the line is moved by
infinitesimal amounts, far less along u than along v. A vertex at the line's u is taken as left of
it, and an edge at exactly the line's height as below it. For all three axes u comes before v in the
order x, y, z, so lines are perturbed consistently.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import inlined, no_refcount
from .sorting import sort_by_group

AXES = ((1, 2, 0), (0, 2, 1), (0, 1, 2))
"""For lines along x, y, z: the axes (u, v) of the plane across them, and their own axis."""
FLIP = (1, -1, 1)
"""Signs of hits along x, y, z: x cross z points along -y."""
CELLS_EACH = 4
"""Cells for each line, of the grid that finds the lines under a face."""
HITS_EACH = 8
"""Hits for each line, of a block that is listed at a time."""


class LineHits(NamedTuple):
    """Hits of lines on faces, shape (h,) each: the numbers of face and line; where; and the sign.

    `ahead` is how far along the axis the hit lies from the point that the line leads through.
    `sign` is +1 where the line leaves through the back of the face, along its normal, else -1.
    """

    face: NDArray[np.int32]
    line: NDArray[np.intp]
    ahead: NDArray[np.float64]
    sign: NDArray[np.int8]


def line_hits(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    points: NDArray[np.float64],
    axis: int,
) -> Iterator[LineHits]:
    """Yield the hits of the lines through points along an axis, in blocks of ascending faces.

    Shapes: vertices (n, 3) in the unit cube, faces (m, 3), points (p, 3).
    """
    first = 0
    while first < len(faces):
        hits, first = next_hits(vertices, faces, points, axis, first)
        yield hits


def next_hits(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    points: NDArray[np.float64],
    axis: int,
    first: int,
) -> tuple[LineHits, int]:
    """Return a block of hits, see `line_hits`, on faces from the first on, and the face after."""
    across = np.ascontiguousarray(points[:, AXES[axis]])
    columns = int(np.sqrt(CELLS_EACH * len(points))) + 1
    u, v = np.clip((across[:, :2] * columns).astype(np.int64), 0, columns - 1).T
    start, order = sort_by_group(u * columns + v, columns * columns)
    room = (HITS_EACH + 1) * len(points)  # the last face may hit all of them
    block: list[NDArray[Any]] = [
        np.empty(room, kind) for kind in (np.int32, np.int64, np.float64, np.int8)
    ]
    projected = np.ascontiguousarray(vertices[:, AXES[axis]])
    count, first = _list_hits(projected, faces, across[order], start, columns, first, *block)
    face, line, ahead, sign = (values[:count] for values in block)
    return LineHits(face, order[line], ahead, FLIP[axis] * sign), first


@no_refcount
def _list_hits(vertices, faces, points, start, columns, f, face, line, ahead, sign):
    """List hits on faces from f on while there is room for one more; return their number, and f.

    Points in the cell i * columns + j of the grid are those from start[i * columns + j] on.
    """
    count = 0
    while f < len(faces) and count + len(points) <= len(face):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        low_u = min(vertices[a, 0], vertices[b, 0], vertices[c, 0])
        high_u = max(vertices[a, 0], vertices[b, 0], vertices[c, 0])
        low_v = min(vertices[a, 1], vertices[b, 1], vertices[c, 1])
        high_v = max(vertices[a, 1], vertices[b, 1], vertices[c, 1])
        for i in range(_cell(low_u, columns), _cell(high_u, columns) + 1):
            low, high = i * columns + _cell(low_v, columns), i * columns + _cell(high_v, columns)
            for p in range(start[low], start[high + 1]):
                u, v = points[p, 0], points[p, 1]
                if not (low_u <= u < high_u and low_v <= v <= high_v):
                    continue
                v0, along0, v1, along1, side = column_span(vertices, faces, f, u)
                if v0 <= v < v1:
                    face[count], line[count], sign[count] = f, p, side
                    ahead[count] = height_between(v0, along0, v1, along1, v) - points[p, 2]
                    count += 1
        f += 1
    return count, f


@inlined
def _cell(coordinate, columns):
    return min(max(int(coordinate * columns), 0), columns - 1)


@no_refcount
def column_span(vertices, faces, f, pu):
    """Intersect the line u = pu with the triangle f.

    Returns the two ends of the intersection as (v, along), lower v first, and the sign of the
    hits on it: +1 if the triangle is counter-clockwise in the (u, v) plane, so that rays leave
    through it, else -1. If the line misses the triangle, the two ends are equal.
    """
    right_v = left_v = right_a = left_a = 0.0
    for k in range(3):
        a, b = faces[f, k], faces[f, (k + 1) % 3]
        a_left = vertices[a, 0] <= pu
        if a_left == (vertices[b, 0] <= pu):
            continue
        if a_left:
            right_v, right_a = edge_height(vertices, a, b, pu)
        else:
            left_v, left_a = edge_height(vertices, b, a, pu)
    if right_v <= left_v:
        return right_v, right_a, left_v, left_a, 1
    return left_v, left_a, right_v, right_a, -1


@inlined
def edge_height(vertices, a, b, pu):
    """Return v and the third coordinate of an edge at u = pu; a is its left end.

    At the left end itself the result is exact.
    """
    width = vertices[b, 0] - vertices[a, 0]
    step = pu - vertices[a, 0]
    v = vertices[a, 1] + step * (vertices[b, 1] - vertices[a, 1]) / width
    along = vertices[a, 2] + step * (vertices[b, 2] - vertices[a, 2]) / width
    return v, along


@inlined
def height_between(low_v, low_a, high_v, high_a, pv):
    """Interpolate the coordinate along the ray at v = pv between the two ends of a span."""
    along = low_a + (pv - low_v) * (high_a - low_a) / (high_v - low_v)
    return min(max(along, min(low_a, high_a)), max(low_a, high_a))
