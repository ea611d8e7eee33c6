"""Pulling a path of nodes taut, as far as straight pieces stay inside the body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .inside import Inside

STRAIGHT = 1.005
"""A piece may be straight if the field falls by at most this factor more than its length: along a
shortest path it falls by the length."""
SLACK = 0.9
"""The share of a straight piece's length by which the field must fall along it."""


def taut(
    inside: Inside,
    points: NDArray[np.float64],
    field: NDArray[np.float64],
    feet: NDArray[np.float64],
) -> list[int]:
    """Find the shortest path that is made of some points of a path and ends on the bone.

    Shapes: points (n, 3), field (n,), feet (n, 3).
    """
    count = len(points)
    start, end = np.triu_indices(count + 1, 1)
    end_of = np.where((end < count)[:, None], points[np.minimum(end, count - 1)], feet[start])
    length = np.full((count + 1, count + 1), np.inf)
    distance = np.linalg.norm(end_of - points[start], axis=1)
    fall = field[start] - np.append(field, 0.0)[end]
    may = (fall <= distance * STRAIGHT) & (fall >= SLACK * distance)
    may |= end == start + 1  # edges, and the way to the bone from the node next to it
    length[start[may], end[may]] = distance[may]
    is_tested = np.eye(count + 1, k=1, dtype=bool)
    while True:
        path = _shortest(length)
        pairs = np.stack([path[:-1], path[1:]], axis=1)
        new = pairs[~is_tested[pairs[:, 0], pairs[:, 1]]]
        if not len(new):
            return path[:-1]
        # All pieces of the path at once; where one fails, those beside it are next.
        ends = np.where(
            (new[:, 1] < count)[:, None],
            points[np.minimum(new[:, 1], count - 1)],
            feet[new[:, 0]],
        )
        for (a, b), is_in in zip(new, inside.segments(points[new[:, 0]], ends), strict=True):
            is_tested[a, b] = True
            if not is_in.all():
                length[a, b] = np.inf


def _shortest(length: NDArray[np.float64]) -> list[int]:
    """Return the shortest way from the first to the last, only upwards; of equals the fewest."""
    last = len(length) - 1
    left, following = np.zeros(last + 1), np.zeros(last + 1, int)
    for k in range(last - 1, -1, -1):
        total = length[k, k + 1 :] + left[k + 1 :]
        best = int(np.flatnonzero(total <= total.min() * (1 + 1e-9))[-1])
        left[k], following[k] = total[best], k + 1 + best
    path = [0]
    while path[-1] < last:
        path.append(int(following[path[-1]]))
    return path
