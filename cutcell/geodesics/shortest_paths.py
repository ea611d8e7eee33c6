"""Shortest paths along the graph's edges from all bones (paper section 3.2, algorithm 2).

Nodes are numbered anew along the body's longest side and swept, forth and back in turn. A
node whose distances fell since its last visit lowers its neighbours'; a path that keeps
its direction is found in one sweep, and most follow a limb out. When no node waits for a
visit, every distance is at most its neighbours' plus the edge, which is what Dijkstra's
algorithm arrives at, too.

A sweep does not leave a slice of the body before nothing waits in it, and so within that slice:
what it passes on is rarely mended later.

LANES bones share each visit and each edge read from memory, and one vector instruction
lowers the distances of all.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled, lean
from ..graph import CutCellGraph
from ..graph.neighbours import Adjacency, list_neighbours
from ..progress import Progress, Shares, Tell, silent
from ..threads import in_threads, parts, threads
from .bones import Sources
from .lanes import LANES, lower

SLICES = 8
"""The body is cut into so many, and each of them again."""


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
    result = np.empty((groups * LANES, len(targets)))
    begin, end = place[sources.node], place[targets]

    shares = Shares(progress, "distances", groups)

    def one_group(group: int) -> None:
        lane = sources.bone - group * LANES
        mine = (lane >= 0) & (lane < LANES)
        distance, waiting = np.full((len(place), LANES), np.inf), np.zeros(len(place), np.bool_)
        np.minimum.at(distance, (begin[mine], lane[mine]), sources.distance[mine])
        waiting[begin[mine]] = True
        _sweep_body(adjacency, waiting, distance, lambda done: shares.tell(group, done))
        result[group * LANES : (group + 1) * LANES] = distance[end].T
        shares.tell(group, 1.0)

    in_threads(one_group, range(groups))
    return result[:bones]


def _along_body(graph: CutCellGraph) -> tuple[NDArray[np.int32], Adjacency]:
    """Sort the nodes along the longest side: return the place of each, and their neighbours.

    Nodes at one height keep their order, which is ascending for lattice points. Heights
    have 16 bits, many to a lattice cell, because these are sorted in linear time.
    """
    side = np.argmax(np.ptp(graph.nodes[: graph.first_point], axis=0))
    height = np.clip(graph.nodes[:, side], 0, 1)  # vertices of no face may lie anywhere
    height = (height * np.iinfo(np.uint16).max).astype(np.uint16)
    order = np.argsort(height, kind="stable")
    place = np.empty(len(order), np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    edges = np.empty_like(graph.edges)
    shares = parts(len(edges), threads())
    in_threads(lambda own: _renumber(graph.edges[own], place, edges[own]), shares)
    return place, list_neighbours(edges, graph.lengths, len(place))


@lean
def _renumber(edges, place, renumbered):
    for e in range(len(edges)):
        renumbered[e, 0], renumbered[e, 1] = place[edges[e, 0]], place[edges[e, 1]]


def _sweep_body(
    adjacency: Adjacency,
    waiting: NDArray[np.bool_],
    distance: NDArray[np.float64],
    tell: Tell,
) -> None:
    """Sweep thick slices, forth and back, until no node waits.

    Nobody knows how many sweeps are left: of what is, each is told as a half.
    """
    forth, waited, left = True, True, 1.0
    while waited:
        waited = False
        for k in range(SLICES):
            bounds = _slice(0, len(waiting), k, forth)
            waited |= _sweep_slice(*adjacency, waiting, distance, *bounds, forth)
            tell(1 - left)
        forth, left = not forth, left / 2


@lean
def _sweep_slice(indptr, indices, lengths, waiting, distance, first, last, forth):
    """Sweep thin slices of a thick one until no node waits in it; tell whether any did."""
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


@lean
def _sweep_nodes(adjacency, waiting, distance, first, last, forth):
    """Visit the nodes of a thin slice until none of them waits; tell whether any did."""
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
                    # Told without a branch, which the processor would have to guess.
                    waiting[u] |= lower(distance, u, v, lengths[e])  # type: ignore[call-arg]
        any_waited |= waited
        forth = not forth
    return any_waited


@compiled(inline="always")
def _slice(first, last, k, forth):
    """Return where the k-th of SLICES begins and ends; counted from the end if not `forth`."""
    k = k if forth else SLICES - 1 - k
    return first + (last - first) * k // SLICES, first + (last - first) * (k + 1) // SLICES
