"""Shortest paths along the graph's edges from all bones (paper section 3.2, algorithm 2).

Nodes are renumbered along the body's longest side and swept forth and back. A visit to a node whose
distances fell since the last one relaxes its edges. A path that keeps its direction is found in one
sweep, and most paths follow a limb outward. When no node is waiting for a visit, every distance is
at most that of any neighbour plus the edge: the fixed point is that of Dijkstra's algorithm.

The body is divided into slices, and these again. A sweep leaves a slice only when no node of it is
waiting, so the distances that it passes on rarely fall again later.

BATCH bones share each visit and each edge read from memory.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..bones.bones import Sources
from ..geometry.edges import Adjacency, list_neighbours
from ..graph import CutCellGraph
from ..runtime.compiled import compiled, no_refcount
from ..runtime.progress import Progress, Shares, Tell, silent
from ..runtime.threads import in_threads

BONES_TOGETHER = 8
"""Bones whose distances to a node are next to each other: they fill a cache line."""
SLICES = 8
"""Slices that the body is divided into, and slices of each of these."""


def shortest_paths(
    graph: CutCellGraph,
    sources: Sources,
    bones: int,
    targets: NDArray[np.int32],
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Compute the length of the shortest path from each bone to each target node.

    Shapes: targets (t,); returns (b, t).
    """
    rank, adjacency = _sort_along_body(graph)
    groups = -(-bones // BONES_TOGETHER)
    result = np.empty((groups * BONES_TOGETHER, len(targets)))
    begin, end = rank[sources.node], rank[targets]

    shares = Shares(progress, "distances", groups)

    def one_group(group: int) -> None:
        column = sources.bone - group * BONES_TOGETHER
        in_group = (column >= 0) & (column < BONES_TOGETHER)
        distance, waiting = (
            np.full((len(rank), BONES_TOGETHER), np.inf),
            np.zeros(len(rank), np.bool_),
        )
        np.minimum.at(distance, (begin[in_group], column[in_group]), sources.distance[in_group])
        waiting[begin[in_group]] = True
        _sweep_body(adjacency, waiting, distance, lambda done: shares.tell(group, done))
        result[group * BONES_TOGETHER : (group + 1) * BONES_TOGETHER] = distance[end].T
        shares.tell(group, 1.0)

    in_threads(one_group, range(groups))
    return result[:bones]


def _sort_along_body(graph: CutCellGraph) -> tuple[NDArray[np.int32], Adjacency]:
    """Sort the nodes along the longest side; return the rank of each, and the adjacency by rank.

    Nodes of equal height keep their order, which is ascending for lattice points. Heights are
    rounded to 16 bits, much finer than a lattice cell, as these sort in linear time.
    """
    side = np.argmax(np.ptp(graph.nodes[: graph.first_point], axis=0))
    height = np.clip(graph.nodes[:, side], 0, 1)  # vertices without faces may lie anywhere
    height = (height * np.iinfo(np.uint16).max).astype(np.uint16)
    order = np.argsort(height, kind="stable")
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    return rank, list_neighbours(rank[graph.edges], graph.lengths, len(rank))


def _sweep_body(
    adjacency: Adjacency,
    waiting: NDArray[np.bool_],
    distance: NDArray[np.float64],
    report: Tell,
) -> None:
    """Sweep the slices forth and back until no node is waiting.

    The number of sweeps is unknown: progress treats each as half of the rest.
    """
    forth, waited, left = True, True, 1.0
    while waited:
        waited = False
        for k in range(SLICES):
            bounds = _slice(0, len(waiting), k, forth)
            waited |= _sweep_slice(*adjacency, waiting, distance, *bounds, forth)
            report(1 - left)
        forth, left = not forth, left / 2


@no_refcount
def _sweep_slice(indptr, indices, lengths, waiting, distance, first, last, forth):
    """Sweep the slices of a slice until no node of it is waiting; tell whether any was."""
    adjacency = indptr, indices, lengths
    any_waited, waited = False, True
    while waited:
        waited = False
        for k in range(SLICES):
            begin, end = _slice(first, last, k, forth)
            waited |= _sweep_nodes(adjacency, waiting, distance, begin, end, forth)
        any_waited |= waited
        forth = not forth
    return any_waited


@no_refcount
def _sweep_nodes(adjacency, waiting, distance, first, last, forth):
    """Visit the nodes of the smallest slices until none is waiting; tell whether any was."""
    indptr, indices, lengths = adjacency
    any_waited, waited = False, True
    while waited:
        waited = False
        for k in range(last - first):
            v = first + k if forth else last - 1 - k
            if waiting[v]:
                waited, waiting[v] = True, False
                for e in range(indptr[v], indptr[v + 1]):
                    u = indices[e]
                    for bone in range(BONES_TOGETHER):
                        through = distance[v, bone] + lengths[e]
                        if through < distance[u, bone]:
                            distance[u, bone], waiting[u] = through, True
        any_waited |= waited
        forth = not forth
    return any_waited


@compiled(inline="always")
def _slice(first, last, k, forth):
    """Return where the k-th of SLICES begins and ends; counted from the end if not `forth`."""
    k = k if forth else SLICES - 1 - k
    return first + (last - first) * k // SLICES, first + (last - first) * (k + 1) // SLICES
