"""Edges as adjacency lists."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled
from ..runtime.threads import in_threads, parts, threads

Adjacency: TypeAlias = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]


def list_neighbours(
    edges: NDArray[np.int32], lengths: NDArray[np.float64], count: int
) -> Adjacency:
    """List the neighbours of each of `count` nodes: indptr (N + 1,), indices and lengths (2E,)."""
    # Each thread reads all edges, and writes the neighbours of a part of the nodes.
    shares = parts(count, threads())
    indptr = np.zeros(count + 1, np.int32)
    in_threads(lambda part: count_ends(edges, part.start, part.stop, indptr[1:]), shares)
    np.cumsum(indptr, out=indptr)
    indices, both_ways = np.empty(2 * len(edges), np.int32), np.empty(2 * len(edges))
    lists = indptr[:-1].copy(), indices, both_ways
    in_threads(lambda part: list_ends(edges, lengths, part.start, part.stop, *lists), shares)
    return indptr, indices, both_ways


@compiled
def count_ends(edges, first, last, ends):
    """Count the edges that end at each of some nodes."""
    for e in range(len(edges)):
        for side in range(2):
            if first <= edges[e, side] < last:
                ends[edges[e, side]] += 1


@compiled
def list_ends(edges, lengths, first, last, cursor, indices, both_ways):
    """List the neighbours of some nodes, and their distances if lengths are given.

    `cursor` holds the next free index of each node.
    """
    for e in range(len(edges)):
        for side in range(2):
            node = edges[e, side]
            if first <= node < last:
                indices[cursor[node]] = edges[e, 1 - side]
                if len(lengths):
                    both_ways[cursor[node]] = lengths[e]
                cursor[node] += 1
