"""Shortest paths from many bones at once (paper section 3.2, algorithm 2)."""

from __future__ import annotations

import numpy as np
from numba import get_num_threads, njit, prange
from numpy.typing import NDArray

from ..graph import CutCellGraph
from ..progress import Progress, silent
from .bones import Sources

ROUNDS = 4
"""Bones a thread works off between two reports of progress."""


def shortest_paths(
    graph: CutCellGraph,
    sources: Sources,
    bones: int,
    targets: NDArray[np.int32],
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Compute the length of the shortest path from each bone to each target node.

    Dijkstra's algorithm from all sources of a bone together, each starting at its own
    distance to the bone; bones run in parallel.

    Parameters
    ----------
    graph : CutCellGraph
    sources : Sources
    bones : int
        b, the number of bones.
    targets : array, shape (t,), int32
        Nodes whose distances are wanted.
    progress : callable
        Called with the stage "distances".

    Returns
    -------
    array, shape (b, t), float64
        Infinite where no path leads.
    """
    indptr, indices, lengths = graph.adjacency
    start = np.searchsorted(sources.bone, np.arange(bones + 1))
    result = np.empty((bones, len(targets)))
    step = ROUNDS * get_num_threads()
    for first in range(0, bones, step):
        progress("distances", first / bones)
        part = start[first : first + step + 1]
        _all_bones(
            indptr,
            indices,
            lengths,
            part,
            sources.node,
            sources.distance,
            targets,
            result[first : first + step],
        )
    progress("distances", 1.0)
    return result


@njit(cache=True, parallel=True)
def _all_bones(indptr, indices, lengths, start, source, source_distance, targets, result):
    for bone in prange(len(start) - 1):
        mine = slice(start[bone], start[bone + 1])
        distance = _dijkstra(indptr, indices, lengths, source[mine], source_distance[mine])
        for t in range(len(targets)):
            result[bone, t] = distance[targets[t]]


@njit(cache=True)
def _dijkstra(indptr, indices, lengths, source, source_distance):
    distance = np.full(len(indptr) - 1, np.inf)
    keys = np.empty(1024)
    nodes = np.empty(1024, np.int32)
    size = 0
    for s in range(len(source)):
        distance[source[s]] = source_distance[s]
        keys, nodes, size = _push(keys, nodes, size, source_distance[s], source[s])
    while size > 0:
        key, node = keys[0], nodes[0]
        size = _pop(keys, nodes, size)
        if key > distance[node]:
            continue  # reached on a shorter path since
        for e in range(indptr[node], indptr[node + 1]):
            reached = key + lengths[e]
            if reached < distance[indices[e]]:
                distance[indices[e]] = reached
                keys, nodes, size = _push(keys, nodes, size, reached, indices[e])
    return distance


@njit(cache=True)
def _push(keys, nodes, size, key, node):
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
def _doubled(array):
    larger = np.empty(2 * len(array), array.dtype)
    larger[: len(array)] = array
    return larger


@njit(cache=True, inline="always")
def _pop(keys, nodes, size):
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
