"""Weld the vertices that exporters split at texture and normal seams."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled
from .triangles import first_of_set
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

    Merged points lie in the middle of their bounding box. The result is sorted along an oblique
    direction, so it does not depend on the order of the input.

    Shapes: points (n, 3); returns welded (k, 3), index (n,).
    """
    x, y, z = points.T
    projection = OBLIQUE[0] * x + OBLIQUE[1] * y + OBLIQUE[2] * z
    order = np.argsort(projection)
    tied = np.flatnonzero(np.diff(projection[order]) == 0)
    if (points[order[tied]] != points[order[tied + 1]]).any():
        order = np.lexsort((z, y, x, projection))
    projection, ordered = projection[order], points[order]
    # Rounding changes a projection by less than this; per point, so that one outlier far away
    # does not widen the search for all.
    slack = tolerance + 8 * np.finfo(float).eps * np.abs(ordered).max(axis=1, initial=0)
    first, middle = _merge(projection, ordered, tolerance, slack)
    is_first = first == np.arange(len(points))
    index = np.empty(len(points), np.int32)
    index[order] = (np.cumsum(is_first) - 1)[first]
    return middle[is_first], index


@compiled
def _merge(projection, points, tolerance, slack):
    """Return each point's group's first point and, there, middle."""
    count = len(points)
    first = np.arange(count)
    for i in range(count):
        j = i + 1
        while j < count and projection[j] - projection[i] <= slack[i]:
            displacement = between(points[i], points[j])
            squared = dot(displacement, displacement)
            if squared <= tolerance * tolerance:
                a, b = first_of_set(first, i), first_of_set(first, j)
                first[max(a, b)] = min(a, b)
            if squared == 0:  # j lies at the same point and will meet whatever follows
                break
            j += 1
    low, high = points.copy(), points.copy()
    for i in range(count):
        first[i] = first[first[i]]  # those before are final
        for axis in range(3):
            low[first[i], axis] = min(low[first[i], axis], points[i, axis])
            high[first[i], axis] = max(high[first[i], axis], points[i, axis])
    return first, (low + high) / 2
