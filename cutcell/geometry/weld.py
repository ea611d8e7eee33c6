"""Weld the vertices that exporters split at texture and normal seams."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled
from .union_find import labels, union
from .vectors import between, dot

WELD_TOLERANCE = 1e-6
"""Of the bounding box's longest side: far above float32 rounding, far below any detail."""

OBLIQUE = 0.7548777, 0.5698403, 0.3183099
"""Points are sorted by their projection onto this vector. Its length is below 1, so no two points
are further apart along it than in space; it is oblique to walls and floors, so few projections
tie."""


def weld(
    points: NDArray[np.float64], tolerance: float = WELD_TOLERANCE
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Merge points that lie within `tolerance` of each other, also in chains.

    The result is sorted along an oblique direction, so it does not depend on the order of the
    input.

    Shapes: points (n, 3); returns welded (k, 3), index (n,).
    """
    x, y, z = points.T
    projection = OBLIQUE[0] * x + OBLIQUE[1] * y + OBLIQUE[2] * z
    order = np.argsort(projection)
    projection, ordered = projection[order], points[order]
    _sort_ties(projection, ordered, order)
    # Rounding changes a projection by less than this; per point, so that one outlier far away
    # does not widen the search for all.
    slack = tolerance + 8 * np.finfo(float).eps * np.abs(ordered).max(axis=1, initial=0)
    welded, group = _merge(projection, ordered, tolerance, slack)
    index = np.empty(len(points), np.int32)
    index[order] = group
    return welded, index


@compiled
def _sort_ties(projection, points, order):
    """Sort points with equal projections by their coordinates."""
    for i in range(1, len(projection)):
        k = i
        while k > 0 and projection[k - 1] == projection[k] and _precedes(points[k], points[k - 1]):
            for axis in range(3):
                points[k, axis], points[k - 1, axis] = points[k - 1, axis], points[k, axis]
            order[k], order[k - 1] = order[k - 1], order[k]
            k -= 1


@compiled(inline="always")
def _precedes(a, b):
    if a[0] != b[0]:
        return a[0] < b[0]
    if a[1] != b[1]:
        return a[1] < b[1]
    return a[2] < b[2]


@compiled
def _merge(projection, points, tolerance, slack):
    """Return the first point of each group, and the group of each point."""
    count = len(points)
    first = np.arange(count)
    for i in range(count):
        j = i + 1
        while j < count and projection[j] - projection[i] <= slack[i]:
            displacement = between(points[i], points[j])
            squared = dot(displacement, displacement)
            if squared <= tolerance * tolerance:
                union(first, i, j)
            if squared == 0:  # j lies at the same point and will meet whatever follows
                break
            j += 1
    group, lowest = labels(first)
    return points[lowest], group
