"""Wavefronts of any-angle paths: bones and joints ranked by position, and labels of the sources."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from ...bones.bones import Bones, Sources
from ...geometry.vectors import TIE
from ...graph import CutCellGraph
from ...runtime.compiled import compiled
from .contraction import Contraction
from .labels import UNUSED_JOINT, bucket_of, find_room, join, limit_of, no_labels


@dataclass(frozen=True, eq=False)
class Ranking:
    """Bones, joints and sources sorted by position, so that ties do not depend on numbering.

    Parameters
    ----------
    joints : array, shape (j,)
        The joint of each rank.
    places : array, shape (j, 3)
        The start of the first bone of each.
    table : array, shape (b, 7)
        Of each bone: its start, the displacement to its end, and one over its squared length.
    rank : array, shape (b,), int32
        The rank of each bone's joint.
    sources : Sources
        With bones as in the table, ascending.
    """

    joints: NDArray[np.int32]
    places: NDArray[np.float64]
    table: NDArray[np.float64]
    rank: NDArray[np.int32]
    sources: Sources


@dataclass(frozen=True, eq=False)
class Wavefront:
    """Labels of joints that propagate together.

    Parameters
    ----------
    each : int
        k, labels a node.
    labels, parents : arrays, shape (N * k,)
        See `labels`.
    least : array, shape (N,)
        The distance of the nearest joint to each node found so far.
    """

    each: int
    labels: NDArray[np.void]
    parents: NDArray[np.int32]
    least: NDArray[np.float64]


def rank_bones(
    graph: CutCellGraph, contraction: Contraction, bones: Bones, sources: Sources
) -> Ranking:
    """Order bones, joints and sources by position."""
    order = graph.lattice.order(bones.start, bones.end)
    start, along = bones.start[order], (bones.end - bones.start)[order]
    squared = (along**2).sum(axis=1)
    inverse = np.divide(1, squared, out=np.zeros(len(order)), where=squared > 0)
    joints, first, number = np.unique(bones.joint[order], return_index=True, return_inverse=True)
    by_bone = np.argsort(first)  # joints in the order of their first bones
    rank = np.argsort(by_bone)[number].astype(np.int32)
    row = np.argsort(order).astype(np.int32)[sources.bone]
    ranked = np.argsort(row, kind="stable")
    return Ranking(
        joints[by_bone],
        start[first[by_bone]],
        np.column_stack([start, along, inverse]),
        rank,
        Sources(contraction.number[sources.node[ranked]], row[ranked], sources.distance[ranked]),
    )


def partition_sources(places: NDArray[np.float64]) -> list[NDArray[np.bool_]]:
    """Partition joints at places (j, 3) into two groups, neighbours into different ones.

    Each joint in turn goes to the group that its nearest predecessor is not in. A single joint is
    one group.
    """
    distance = np.rint(cdist(places, places) / TIE)
    odd = np.zeros(len(places), np.bool_)
    for k in range(1, len(places)):
        odd[k] = not odd[distance[k, :k].argmin()]
    return [half for half in (~odd, odd) if half.any()]


def begin(
    ranking: Ranking,
    nodes: int,
    group: NDArray[np.bool_],
    each: int,
    least: NDArray[np.float64] | None = None,
) -> Wavefront:
    """Start a wavefront of `each` labels a node: label the sources of a group of joints, by rank.

    Shapes: group (j,); least (N,), the distance of the nearest joint to each node, if known.
    """
    labels, parents = no_labels(nodes, each)
    least = np.full(nodes, np.inf) if least is None else least.copy()
    sources = ranking.sources.node, ranking.sources.bone, ranking.sources.distance
    _enter_sources(labels, parents, least, each, group, ranking.rank, *sources)
    return Wavefront(each, labels, parents, least)


@compiled
def _enter_sources(labels, parents, least, each, group, rank, node, bone, distance):
    for s in range(len(node) - 1, -1, -1):  # of equally near bones the first one stays
        joint, parent = rank[bone[s]], ~bone[s]
        if not group[joint]:
            continue
        label = find_room(labels, each, node[s], joint)
        if distance[s] < limit_of(labels, label, joint):
            labels[label].joint, parents[label] = joint, parent
            labels[label].distance = distance[s]
            least[node[s]] = min(least[node[s]], distance[s])


@compiled
def enqueue(labels, each, head, scale, node, number):
    """Insert all used labels into the queue, in the order of the graph's nodes.

    `node` and `number` are those of the contraction. However it numbers nodes, the result of paths
    of equal length is the same.
    """
    for n in range(len(number)):
        v = number[n]
        if node[v] != n:
            continue
        for label in range(v * each, v * each + each):
            if labels[label].joint != UNUSED_JOINT:
                join(head, labels, bucket_of(head, scale, labels[label].distance), label)
