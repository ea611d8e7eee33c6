"""Edges as adjacency lists."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled

Adjacency: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]


@compiled
def list_neighbours(edges, lengths, count):
    """List the neighbours of each of `count` nodes, and their distances if lengths are given.

    Shapes: edges (e, 2), lengths (e,) or (0,); returns indptr (count + 1,), indices and lengths
    (2 e,).
    """
    indptr = np.zeros(count + 1, np.int32)
    for e in range(len(edges)):
        for side in range(2):
            indptr[edges[e, side] + 1] += 1
    for node in range(count):
        indptr[node + 1] += indptr[node]
    cursor, indices = indptr[:-1].copy(), np.empty(2 * len(edges), np.int32)
    both_ways = np.empty(2 * len(lengths))
    for e in range(len(edges)):
        for side in range(2):
            node = edges[e, side]
            indices[cursor[node]] = edges[e, 1 - side]
            if len(lengths):
                both_ways[cursor[node]] = lengths[e]
            cursor[node] += 1
    return indptr, indices, both_ways
