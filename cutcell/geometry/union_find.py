"""Disjoint sets (union-find, Tarjan 1975), each represented by its lowest member.

`first` begins as `np.arange(count)`: each entry is a member of the same set, no later than itself.
"""

from __future__ import annotations

import numpy as np

from ..runtime.compiled import compiled


@compiled(inline="always")
def find(first, i):
    """Return the lowest member of the set of i."""
    while first[i] != i:
        first[i] = first[first[i]]
        i = first[i]
    return i


@compiled(inline="always")
def union(first, i, j):
    """Merge the sets of i and j; return the lowest member."""
    a, b = find(first, i), find(first, j)
    low = min(a, b)
    first[max(a, b)] = low
    return low


@compiled
def labels(first):
    """Return each member's set, numbered by its lowest member, and these lowest members."""
    count = len(first)
    group, lowest = np.empty(count, np.int32), np.empty(count, np.int64)
    groups = 0
    for i in range(count):
        low = find(first, i)
        if low == i:
            group[i], lowest[groups] = groups, i
            groups += 1
        else:
            group[i] = group[low]
    return group, lowest[:groups]
