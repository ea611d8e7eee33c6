"""Edges as lists of neighbours."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

Adjacency: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]


def list_neighbours(
    edges: NDArray[np.int32], lengths: NDArray[np.float64], count: int
) -> Adjacency:
    """List the neighbours of each of `count` nodes: indptr (N + 1,), indices and lengths (2E,)."""
    return sort_edges(edges, lengths, count)


@njit(cache=True, nogil=True)
def sort_edges(edges, lengths, count):
    """List neighbours; see `list_neighbours`. Without lengths there are none in the list."""
    # Where the neighbours of a node begin stands one place further until they are all there.
    start = np.zeros(count + 2, np.int32)
    for e in range(len(edges)):
        for side in range(2):
            start[edges[e, side] + 2] += 1
    for node in range(count):
        start[node + 2] += start[node + 1]
    indices, both_ways = np.empty(2 * len(edges), np.int32), np.empty(2 * len(lengths))
    for e in range(len(edges)):
        for side in range(2):
            at = start[edges[e, side] + 1]
            indices[at] = edges[e, 1 - side]
            if len(lengths):
                both_ways[at] = lengths[e]
            start[edges[e, side] + 1] += 1
    return start[:-1], indices, both_ways
