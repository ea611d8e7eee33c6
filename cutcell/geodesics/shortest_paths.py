"""Shortest paths along the graph's edges from all bones (paper section 3.2, algorithm 2).

Bones are worked off LANES at a time: all of them share each visit of a node and each edge
read from memory, and one vector instruction relaxes the edge for all. Nodes are visited in
sweeps, sorted by position once in each direction of the lattice, as in fast sweeping: a
path that never turns back is found in one sweep. Only nodes next to a change are visited
again, until nothing changes. Then every distance is the least over its neighbours' plus
the edge, which is what Dijkstra's algorithm arrives at, too.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..graph import CutCellGraph
from ..progress import Progress, silent
from ..threads import in_threads, threads
from .bones import Sources

LANES = 8


def shortest_paths(
    graph: CutCellGraph,
    sources: Sources,
    bones: int,
    targets: NDArray[np.int32],
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Compute the length of the shortest path from each bone to each target node.

    Parameters
    ----------
    graph : CutCellGraph
    sources : Sources
        Paths of a bone begin at its sources, each at its own distance to the bone.
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
    orders = _sweep_orders(graph.nodes)
    blocks = -(-bones // LANES)
    result = np.empty((blocks * LANES, len(targets)))
    step = threads()
    for first in range(0, blocks, step):
        progress("distances", first / blocks)
        last = min(first + step, blocks)
        distance = np.full((last - first, len(graph.nodes), LANES), np.inf)
        mine = (sources.bone >= first * LANES) & (sources.bone < last * LANES)
        bone = sources.bone[mine] - first * LANES
        distance[bone // LANES, sources.node[mine], bone % LANES] = sources.distance[mine]
        in_threads(lambda block: _relax(*graph.adjacency, orders, block), distance)
        found = distance[:, targets].transpose(0, 2, 1).reshape(-1, len(targets))
        result[first * LANES : last * LANES] = found
    progress("distances", 1.0)
    return result[:bones]


def _sweep_orders(nodes: NDArray[np.float64]) -> NDArray[np.int32]:
    """Sort the nodes by x, y, z for each sign of y and z; reversed, these are all eight."""
    x, y, z = nodes.T
    signs = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    return np.stack([np.lexsort((c * z, b * y, x)) for b, c in signs]).astype(np.int32)


@njit(cache=True, nogil=True)
def _relax(indptr, indices, lengths, orders, distance):
    waiting = np.zeros(len(indptr) - 1, np.bool_)
    for node in range(len(waiting)):
        if distance[node].min() < np.inf:
            waiting[indices[indptr[node] : indptr[node + 1]]] = True
    sweep = 0
    while waiting.any():
        order = orders[sweep // 2 % len(orders)]
        for k in range(len(order)):
            node = order[k] if sweep % 2 == 0 else order[len(order) - 1 - k]
            if waiting[node]:
                waiting[node] = False
                if _relax_node(indptr, indices, lengths, distance, node):
                    for e in range(indptr[node], indptr[node + 1]):
                        waiting[indices[e]] = True
        sweep += 1


@njit(cache=True, inline="always")
def _relax_node(indptr, indices, lengths, distance, v):
    """Lower a node's distances to the least over its neighbours; tell whether any fell.

    The lanes are written out so that they stay in vector registers.
    """
    d0, d1, d2, d3 = distance[v, 0], distance[v, 1], distance[v, 2], distance[v, 3]
    d4, d5, d6, d7 = distance[v, 4], distance[v, 5], distance[v, 6], distance[v, 7]
    for e in range(indptr[v], indptr[v + 1]):
        u, step = np.uint32(indices[e]), lengths[e]
        d0, d1 = min(d0, distance[u, 0] + step), min(d1, distance[u, 1] + step)
        d2, d3 = min(d2, distance[u, 2] + step), min(d3, distance[u, 3] + step)
        d4, d5 = min(d4, distance[u, 4] + step), min(d5, distance[u, 5] + step)
        d6, d7 = min(d6, distance[u, 6] + step), min(d7, distance[u, 7] + step)
    fell = (
        (d0 < distance[v, 0])
        | (d1 < distance[v, 1])
        | (d2 < distance[v, 2])
        | (d3 < distance[v, 3])
        | (d4 < distance[v, 4])
        | (d5 < distance[v, 5])
        | (d6 < distance[v, 6])
        | (d7 < distance[v, 7])
    )
    if fell:
        distance[v, 0], distance[v, 1], distance[v, 2], distance[v, 3] = d0, d1, d2, d3
        distance[v, 4], distance[v, 5], distance[v, 6], distance[v, 7] = d4, d5, d6, d7
    return fell
