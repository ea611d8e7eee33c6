"""Sorting in linear time: items by group, points by cell of a grid."""

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled

CELLS = 64
"""Along each side of the grid that points are sorted into."""


def spatial_order(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """Order points, shape (n, 3), in the unit cube by the cells of a grid that they are in.

    Near points are then near in memory, so that large meshes make better use of the cache.
    """
    x, y, z = (points * CELLS).astype(np.int64).T
    return np.argsort((x * CELLS + y) * CELLS + z, kind="stable")


@compiled
def counting_sort(group, count):
    """Sort items by group, the items of each in order (counting sort).

    Shapes: group (n,); returns start (count + 1,), order (start[-1],).
    """
    start = np.zeros(count + 1, np.int64)
    for item in range(len(group)):
        if group[item] >= 0:
            start[group[item] + 1] += 1
    start = np.cumsum(start)
    cursor, order = start.copy(), np.empty(start[-1], np.int64)
    for item in range(len(group)):
        if group[item] >= 0:
            order[cursor[group[item]]] = item
            cursor[group[item]] += 1
    return start, order
