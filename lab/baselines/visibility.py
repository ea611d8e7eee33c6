"""Whether the surface blocks the line of sight from a vertex on it to a point.

The test is watertight: seen along the segment, two triangles that share an edge compute the same
numbers for it to the last bit, as for the rays of the graph (`geometry.line_hits`). Whatever
rounding does, no segment passes between them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cutcell.geometry.line_hits import AXES, column_span, height_between
from cutcell.runtime.compiled import compiled
from cutcell.runtime.threads import in_threads, parts

LEAF = 4
"""Triangles in a leaf of the tree, at most."""
DEPTH = 64
"""Nodes that wait while a tree is walked; a tree of halves never needs more."""
ENDS = 1e-9
"""Share of a segment at both ends where triangles do not block it."""
MARGIN = 1e-12
"""Boxes are larger by this share of the largest coordinate, far more than rounding."""


class Blockers:
    """A tree of boxes around triangles that answers what a segment meets.

    Parameters
    ----------
    points : array, shape (k, 3), float64
    faces : array, shape (m, 3), int32
    """

    def __init__(self, points: NDArray[np.float64], faces: NDArray[np.int32]) -> None:
        self.points = np.ascontiguousarray(points)
        self.faces, self.low, self.high, self.child, self.first = _build(points, faces)

    def blocked(
        self, vertex: NDArray[np.integer], target: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Return which segments meet a triangle that does not have their first end as a corner.

        Shapes: vertex (q,), target (q, 3); returns (q,).
        """
        tree = (self.faces, self.low, self.high, self.child, self.first)
        vertex = vertex.astype(np.int64)
        blocks = in_threads(
            lambda part: _blocked(self.points, *tree, vertex[part], target[part]),
            parts(len(vertex)),
        )
        return np.concatenate(blocks)


def _build(points, faces):
    """Halve the triangles by their middles along the longest side, again and again."""
    corners = points[faces]
    middle, least, most = corners.mean(axis=1), corners.min(axis=1), corners.max(axis=1)
    order = np.arange(len(faces))
    low, high, child, first = [], [], [], []

    def add(begin: int, end: int) -> int:
        triangles = order[begin:end]
        low.append(least[triangles].min(axis=0))
        high.append(most[triangles].max(axis=0))
        child.append((-1, -1))
        first.append((begin, end))
        return len(low) - 1

    waiting = [(add(0, len(faces)), 0, len(faces))]
    while waiting:
        node, begin, end = waiting.pop()
        if end - begin <= LEAF:
            continue
        axis = int(np.ptp(middle[order[begin:end]], axis=0).argmax())
        half = (end - begin) // 2
        part = order[begin:end]
        order[begin:end] = part[np.argpartition(middle[part, axis], half)]
        left, right = add(begin, begin + half), add(begin + half, end)
        child[node] = (left, right)
        waiting += [(left, begin, begin + half), (right, begin + half, end)]
    margin = MARGIN * np.abs(points).max(initial=0.0)
    return (
        np.ascontiguousarray(faces[order]),
        np.array(low) - margin,
        np.array(high) + margin,
        np.array(child),
        np.array(first),
    )


@compiled
def _blocked(points, faces, low, high, child, first, vertex, target):
    result = np.zeros(len(vertex), np.bool_)
    corners, triangle = np.empty((3, 3)), np.array([[0, 1, 2]])
    for q in range(len(vertex)):
        start = points[vertex[q]]
        direction = target[q] - start
        axis = np.abs(direction).argmax()
        if direction[axis] == 0:
            continue
        stack = np.empty(DEPTH, np.int64)
        stack[0], size = 0, 1
        while size > 0 and not result[q]:
            size -= 1
            node = stack[size]
            if not _meets_box(start, direction, low[node], high[node]):
                continue
            if child[node, 0] >= 0:
                stack[size], stack[size + 1] = child[node, 0], child[node, 1]
                size += 2
                continue
            for f in range(first[node, 0], first[node, 1]):
                if vertex[q] in faces[f]:
                    continue
                for k in range(3):
                    _see_along(points[faces[f, k]], start, direction, axis, corners[k])
                low_v, low_t, high_v, high_t, _ = column_span(corners, triangle, 0, 0.0)
                if low_v <= 0 < high_v:
                    t = height_between(low_v, low_t, high_v, high_t, 0.0)
                    if ENDS < t < 1 - ENDS:
                        result[q] = True
                        break
    return result


@compiled
def _see_along(point, start, direction, axis, seen):
    """Shear space so that the segment runs from 0 to 1 along the third axis; writes seen (3,)."""
    seen[2] = (point[axis] - start[axis]) / direction[axis]
    for k in range(2):
        across = AXES[axis][k]
        seen[k] = point[across] - start[across] - seen[2] * direction[across]


@compiled
def _meets_box(start, direction, low, high):
    enter, leave = 0.0, 1.0
    for axis in range(3):
        if direction[axis] == 0:
            if start[axis] < low[axis] or start[axis] > high[axis]:
                return False
            continue
        a, b = (
            (low[axis] - start[axis]) / direction[axis],
            (high[axis] - start[axis]) / direction[axis],
        )
        enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    return enter <= leave
