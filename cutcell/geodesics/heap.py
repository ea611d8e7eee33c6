"""A binary heap in two arrays, for kernels."""

import numpy as np
from numba import njit


@njit(cache=True)
def heap_push(keys, nodes, size, key, node):
    """Add a node; return the arrays, which may have grown, and the new size."""
    if size == len(keys):
        keys, nodes = _doubled(keys), _doubled(nodes)
    place = size
    while place > 0:
        above = (place - 1) // 2
        if keys[above] <= key:
            break
        keys[place], nodes[place] = keys[above], nodes[above]
        place = above
    keys[place], nodes[place] = key, node
    return keys, nodes, size + 1


@njit(cache=True)
def heap_pop(keys, nodes, size):
    """Remove the first entry, which has the least key; return the new size."""
    size -= 1
    key, node = keys[size], nodes[size]
    place = 0
    while True:
        below = 2 * place + 1
        if below >= size:
            break
        if below + 1 < size and keys[below + 1] < keys[below]:
            below += 1
        if keys[below] >= key:
            break
        keys[place], nodes[place] = keys[below], nodes[below]
        place = below
    keys[place], nodes[place] = key, node
    return size


@njit(cache=True)
def _doubled(array):
    larger = np.empty(2 * len(array), array.dtype)
    larger[: len(array)] = array
    return larger
