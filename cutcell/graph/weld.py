"""Merge the vertices that exporters split at texture and normal seams."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..unions import join, numbered

WELD_TOLERANCE = 1e-6
"""Of the bounding box's longest side: far above float32 rounding, far below any detail."""

SKEW = 0.7548777, 0.5698403, 0.3183099
"""Points are sorted along this direction. It is shorter than 1, so no two points are further
apart along it than in space; and it lies askew to walls and floors, so few share a place."""


def weld(
    points: NDArray[np.float64], tolerance: float = WELD_TOLERANCE
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Merge points that lie within `tolerance` of each other, also in chains.

    The result is sorted along a skew direction, so it does not depend on the order of the
    input.

    Parameters
    ----------
    points : array, shape (n, 3)
    tolerance : float
        In the units of the points.

    Returns
    -------
    welded : array, shape (k, 3)
        One of the given points for each group: the first along that direction.
    index : array, shape (n,), int32
        The group of each point.
    """
    x, y, z = points.T
    place = SKEW[0] * x + SKEW[1] * y + SKEW[2] * z
    order = np.argsort(place)
    place, ordered = place[order], points[order]
    _sort_ties(place, ordered, order)
    # Rounding moves a place by less than this. One stray far away is no reason to compare all.
    slack = tolerance + 8 * np.finfo(float).eps * np.abs(ordered).max(axis=1, initial=0)
    welded, group = _merge(place, ordered, tolerance, slack)
    index = np.empty(len(points), np.int32)
    index[order] = group
    return welded, index


@compiled
def _sort_ties(place, points, order):
    """Sort points at the same place along the direction by their coordinates."""
    for i in range(1, len(place)):
        k = i
        while k > 0 and place[k - 1] == place[k] and _precedes(points[k], points[k - 1]):
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
def _merge(place, points, tolerance, slack):
    """Return the first point of each group, and the group of each point."""
    count = len(points)
    first = np.arange(count)
    for i in range(count):
        j = i + 1
        while j < count and place[j] - place[i] <= slack[i]:
            x = points[j, 0] - points[i, 0]
            y = points[j, 1] - points[i, 1]
            z = points[j, 2] - points[i, 2]
            squared = x * x + y * y + z * z
            if squared <= tolerance * tolerance:
                join(first, i, j)
            if squared == 0:  # j, at the very same point, meets whatever follows
                break
            j += 1
    group, lowest = numbered(first)
    return points[lowest], group
