"""Shortest paths along the graph's edges from all bones (paper section 3.2, algorithm 2).

Nodes are numbered anew along the body's longest side and swept, forth and back in turn. A
node whose distances fell since its last visit lowers its neighbours'; a path that keeps
its direction is found in one sweep, and most follow a limb out. When no node waits for a
visit, every distance is at most its neighbours' plus the edge, which is what Dijkstra's
algorithm arrives at, too.

LANES bones share each visit and each edge read from memory, and one vector instruction
lowers the distances of all.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..graph import CutCellGraph
from ..graph.neighbours import Adjacency, list_neighbours
from ..progress import Progress, silent
from ..threads import in_threads, threads
from .bones import Sources
from .lanes import LANES, lower


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
    place, adjacency = _along_body(graph)
    groups = -(-bones // LANES)
    result = np.empty((groups, LANES, len(targets)))

    def one_group(group: int) -> None:
        mine = sources.bone // LANES == group
        node, lane = place[sources.node[mine]], sources.bone[mine] % LANES
        distance = np.full((len(place), LANES), np.inf)
        np.minimum.at(distance, (node, lane), sources.distance[mine])
        waiting = np.zeros(len(place), np.bool_)
        waiting[node] = True
        _sweep(*adjacency, waiting, distance)
        result[group] = distance[place[targets]].T

    step = 2 * threads()
    for first in range(0, groups, step):
        progress("distances", first / groups)
        in_threads(one_group, range(first, min(first + step, groups)))
    progress("distances", 1.0)
    return result.reshape(-1, len(targets))[:bones]


def _along_body(graph: CutCellGraph) -> tuple[NDArray[np.int32], Adjacency]:
    """Sort the nodes along the longest side: return the place of each, and their neighbours.

    Nodes at one height keep their order, which is ascending for lattice points. Heights
    have 16 bits, many to a lattice cell, because these are sorted in linear time.
    """
    side = np.argmax([np.ptp(along) for along in graph.nodes.T])
    height = (graph.nodes[:, side] * np.iinfo(np.uint16).max).astype(np.uint16)
    order = np.argsort(height, kind="stable")
    place = np.empty(len(order), np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    return place, list_neighbours(place[graph.edges], graph.lengths, len(place))


@njit(cache=True, nogil=True)
def _sweep(indptr, indices, lengths, waiting, distance):
    forth = True
    while waiting.any():
        for k in range(len(waiting)):
            v = k if forth else len(waiting) - 1 - k
            if waiting[v]:
                waiting[v] = False
                for e in range(indptr[v], indptr[v + 1]):
                    u = indices[e]
                    if lower(distance, u, v, lengths[e]):  # type: ignore[call-arg]
                        waiting[u] = True
        forth = not forth
