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
    degree = np.bincount(edges.ravel(), minlength=count)
    indptr = np.concatenate([[0], np.cumsum(degree)]).astype(np.int32)
    indices = np.empty(2 * len(edges), np.int32)
    both_ways = np.empty(2 * len(edges))
    _fill_adjacency(edges, lengths, indptr[:-1].copy(), indices, both_ways)
    return indptr, indices, both_ways


@njit(cache=True)
def _fill_adjacency(edges, edge_lengths, cursor, indices, lengths):
    for e in range(len(edges)):
        for side in range(2):
            node = edges[e, side]
            indices[cursor[node]] = edges[e, 1 - side]
            lengths[cursor[node]] = edge_lengths[e]
            cursor[node] += 1
