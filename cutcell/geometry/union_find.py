"""Groups that grow together (union-find, Tarjan 1975); the lowest member stands for its group.

`first` is an array that begins as `np.arange(count)`: each member names one of its group that is
no later than itself.
"""

from __future__ import annotations

import numpy as np

from ..runtime.compiled import compiled


@compiled(inline="always")
def root(first, i):
    """Return the lowest member of i's group."""
    while first[i] != i:
        first[i] = first[first[i]]
        i = first[i]
    return i


@compiled(inline="always")
def join(first, i, j):
    """Make one group of those of i and j; return its lowest member."""
    a, b = root(first, i), root(first, j)
    low = min(a, b)
    first[max(a, b)] = low
    return low


@compiled
def numbered(first):
    """Return the number of each member's group, in the order of the lowest, and the lowest."""
    count = len(first)
    group, lowest = np.empty(count, np.int32), np.empty(count, np.int64)
    groups = 0
    for i in range(count):
        low = root(first, i)
        if low == i:
            group[i], lowest[groups] = groups, i
            groups += 1
        else:
            group[i] = group[low]
    return group, lowest[:groups]
