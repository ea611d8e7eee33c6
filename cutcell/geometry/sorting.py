"""Items sorted into groups in linear time, and points by place."""

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled

PLACES = 64
"""Cells along each side of the grid that points are sorted into."""


def order_by_place(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """Order points, shape (n, 3), in the unit cube by the cells of a grid that they are in.

    What belongs to near points is then near in memory, too. Of many points it would otherwise be
    read from memory one by one, as little of it fits into the cache.
    """
    x, y, z = (points * PLACES).astype(np.int64).T
    return np.argsort((x * PLACES + y) * PLACES + z, kind="stable")


@compiled
def sort_into(group, count):
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
