"""Items sorted into groups in linear time."""

import numpy as np

from .compiled import compiled


@compiled
def sort_into(group, count):
    """Sort items by group, the items of each in order (counting sort).

    Parameters
    ----------
    group : array, shape (n,), of integers
        0 to count - 1; items with less are left out.
    count : int

    Returns
    -------
    start : array, shape (count + 1,), int64
        Where each group begins.
    order : array, shape (start[-1],), int64
        The items.
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
