"""Straight paths through the body: distances that converge to the geodesic ones.

Paths along lattice edges are too long however fine the lattice: in free space by 50 % on
average with 6 neighbours, by 9 % with 26. Here each node remembers its anchor, the last bend
of its path, and its distance is that of the anchor plus the straight way from there. This
is any-angle path planning (Theta*: Daniel, Nash, Koenig & Felner 2010) on the cut-cell graph, with
the whole bone as first anchor: what sees the bone has its exact distance to the segment.

All joints spread at once, and a node has room for the labels (joint, distance, anchor) of
its nearest few alone. Nothing is lost by that: where k joints are nearer to a node than a
further one, they are also nearer to whatever that one would reach by way of the node. So the
work grows with the labels that a vertex keeps, not with the joints.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..compiled import lean
from ..graph import CutCellGraph
from ..progress import Progress, silent
from ..threads import in_threads, threads
from .bones import TIE, Bones, Sources
from .labels import NOBODY, find_room, follows_anchor, no_labels
from .queue import END, SETTLED, bucket_of, join, leave, move_on
from .sight import bend_of, body_of, sees, straight

NEAR = 2
"""Lattice cells. A far corner of a triangle may lie behind a bend of the surface."""
ON_BONE = 0.5
"""Lattice cells: of what is as near as this, no joint is told to be so many times nearer."""
AT_ONCE = 4
"""Joints that spread together where all are wanted everywhere."""
FINENESS = 4
"""Times R squared: buckets a unit of distance. One is a hundredth of a cell wide, or less."""
SPAN = 1
"""Units of distance that the buckets cover at a time."""
ROOMS = 1, 4, 6
"""Labels a node for which the kernel is compiled with their number built in, a third faster."""
PAUSES = 8
"""How often a unit of distance is interrupted, to report and to be cancelled."""


def any_angle_paths(
    graph: CutCellGraph,
    sources: Sources,
    bones: Bones,
    targets: NDArray[np.int32],
    nearest: int | None = None,
    within: float = np.inf,
    least: NDArray[np.float64] | None = None,
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Compute how long the shortest path of straight pieces from each joint to each node is.

    Parameters
    ----------
    graph : CutCellGraph
        With connectivity "any".
    sources : Sources
        Nodes that see the bone.
    bones : Bones
        In the unit cube. Paths start on any bone of a joint; to tell bones apart, give each
        a joint of its own.
    targets : array, shape (t,), int32
        Nodes whose distances are wanted.
    nearest : int, optional
        k: a node gets the distances of its k nearest joints alone; of all when left out.
    within : float
        Where only some joints are measured, paths do not pass where another joint is so many
        times nearer; half a lattice cell counts as the nearest that one can be.
    least : array, shape (N,), optional
        How far the nearest joint is from each node, where that may be none of these bones'.
    progress : callable
        Called with the stage "distances".

    Returns
    -------
    array, shape (j, t), float64
        For the joints with bones, ascending. Infinite where no path leads and for joints that
        are not among the nearest.
    """
    joints = np.unique(bones.joint)
    if nearest is not None and (nearest < len(joints) or least is not None):
        groups = [joints]
    else:
        nearest, within = min(AT_ONCE, len(joints)), np.inf  # a group knows not who is nearest
        groups = [joints[k : k + nearest] for k in range(0, len(joints), nearest)]
    body = body_of(graph)
    result = np.full((len(joints), len(targets)), np.inf)

    def spread(group: NDArray[np.int32]) -> None:
        report = progress if len(groups) == 1 else silent
        front = _start(graph, sources, bones, group, nearest, least)
        _spread(graph, body, front, within, report)
        found = front.labels.reshape(-1, nearest)[targets]
        at, which = np.nonzero(found["joint"] != NOBODY)
        found = found[at, which]
        result[np.searchsorted(joints, front.joints[found["joint"]]), at] = found["distance"]

    if len(groups) == 1:
        spread(groups[0])
    else:
        step = 4 * threads()
        for first in range(0, len(groups), step):
            progress("distances", first / len(groups))
            in_threads(spread, groups[first : first + step])
    progress("distances", 1.0)
    return result


def least_distances(
    graph: CutCellGraph, sources: Sources, bones: Bones, progress: Progress = silent
) -> NDArray[np.float64]:
    """Compute how far the nearest joint is from each node, shape (N,); see `any_angle_paths`."""
    front = _start(graph, sources, bones, np.unique(bones.joint), 1)
    _spread(graph, body_of(graph), front, np.inf, progress)
    return front.least


@dataclass(frozen=True, eq=False)
class _Front:
    """Labels and bones of a group of joints, ranked by position.

    So ties do not hang on how joints are numbered.

    Parameters
    ----------
    joints : array
        Of each rank.
    bones : array, shape (b, 7)
        Start, way to the end, and one over its squared length.
    each : int
        k, labels a node.
    labels, anchors : arrays, shape (N * k,)
        See `labels`.
    least : array, shape (N,)
        How far the nearest joint is from each node, as far as is known.
    """

    joints: NDArray[np.int32]
    bones: NDArray[np.float64]
    each: int
    labels: NDArray[np.void]
    anchors: NDArray[np.int32]
    least: NDArray[np.float64]


def _start(
    graph: CutCellGraph,
    sources: Sources,
    bones: Bones,
    group: NDArray[np.int32],
    each: int,
    least: NDArray[np.float64] | None = None,
) -> _Front:
    mine = np.flatnonzero(np.isin(bones.joint, group))
    start, end = bones.start[mine], bones.end[mine]
    order = np.lexsort(np.concatenate([start, end], axis=1).T[::-1])
    mine, start, way = mine[order], start[order], (end - start)[order]
    squared = (way * way).sum(axis=1)
    inverse = np.divide(1, squared, out=np.zeros_like(squared), where=squared > 0)
    joints, first, rank = np.unique(bones.joint[mine], return_index=True, return_inverse=True)
    by_place = np.argsort(first)
    rank = np.argsort(by_place)[rank].astype(np.int32)

    place = np.full(len(bones.joint), -1)
    place[mine] = np.arange(len(mine))
    bone = place[sources.bone]
    chosen = np.flatnonzero(bone >= 0)
    chosen = chosen[np.argsort(bone[chosen], kind="stable")]

    labels, anchors = no_labels(len(graph.nodes), each)
    table = np.concatenate([start, way, inverse[:, None]], axis=1)
    least = np.full(len(graph.nodes), np.inf) if least is None else least.copy()
    begin = sources.node[chosen], bone[chosen], sources.distance[chosen]
    _enter_sources(labels, anchors, least, each, rank, *begin)
    return _Front(joints[by_place], table, each, labels, anchors, least)


def _spread(
    graph: CutCellGraph, body: tuple, front: _Front, within: float, progress: Progress
) -> None:
    """Settle all labels."""
    labels = front.labels
    rooms = (0,) * front.each if front.each in ROOMS else np.empty(front.each)
    scale = float(FINENESS * graph.lattice.resolution**2)
    head = np.full(int(SPAN * scale), END, np.int32)
    _line_up(labels, head, scale)
    step = len(head) // (SPAN * PAUSES)
    ahead = np.empty(int(np.diff(graph.adjacency[0]).max()) + 1, np.int64)
    known = graph.adjacency, body, front.bones, within
    given = *known, rooms, labels, front.anchors, front.least, head, scale, ahead
    origin = 0.0
    while True:
        for bucket in range(0, len(head) - 1, step):
            progress("distances", min(origin + bucket / scale, 0.99))
            last = min(bucket + step, len(head) - 1)
            _settle(*given, origin, bucket, last)
            if (head[last:] == END).all():
                return
        origin = move_on(head, scale, labels)


@njit(cache=True)
def _enter_sources(labels, anchors, least, each, rank, node, bone, distance):
    for s in range(len(node)):
        joint, anchor = rank[bone[s]], ~bone[s]
        label = find_room(labels, each, node[s], joint)
        if distance[s] < labels[label].distance:
            labels[label].joint, anchors[label] = joint, anchor
            labels[label].distance = distance[s]
            least[node[s]] = min(least[node[s]], distance[s])


@njit(cache=True)
def _line_up(labels, head, scale):
    for label in range(len(labels)):
        if labels[label].joint != NOBODY:
            join(head, labels, bucket_of(head, scale, labels[label].distance), label)


@lean
def _settle(
    adjacency,
    body,
    bones,
    within,
    rooms,
    labels,
    anchors,
    least,
    head,
    scale,
    ahead,
    origin,
    first,
    last,
):
    """Settle labels by distance, bucket after bucket.

    `rooms` has as many entries as a node has labels; `ahead` is room for a node's edges.
    """
    each = len(rooms)
    indptr, indices, lengths = adjacency
    resolution, first_point, first_crossing, nodes, _, _ = body
    for bucket in range(first, last):
        while head[bucket] != END:
            label = head[bucket]
            leave(head, labels, label)
            labels[label].after = SETTLED
            u, joint, anchor = label // each, labels[label].joint, anchors[label]
            to_anchor = labels[anchor].distance if anchor >= 0 else 0.0
            # Most neighbours follow the anchor already. Which do not is put down without a branch
            # that the processor would have to guess.
            count = 0
            for e in range(indptr[u], indptr[u + 1]):
                ahead[count] = e
                count += not follows_anchor(anchors, each, indices[e], anchor)
            for k in range(count):
                e = ahead[k]
                v = indices[e]
                room = find_room(labels, each, v, joint)
                if labels[room].after == SETTLED:
                    continue
                # Of joints equally near, the first by position stays.
                limit = labels[room].distance
                if labels[room].joint != joint:
                    limit *= 1 + TIE if joint < labels[room].joint else 1 - TIE
                here = nodes[v, 0], nodes[v, 1], nodes[v, 2]
                bend = bend_of(nodes, bones, each, anchor, here)
                reached, bent = to_anchor + straight(here, bend), anchor
                if reached >= limit:
                    continue  # a bend at u would be no shorter
                if reached > within * max(least[v], ON_BONE / resolution):
                    continue
                # Off the lattice, what is one step from a lattice point that sees the bend does,
                # too: a crossing, and from there a corner of its triangle if it is near.
                if v >= first_crossing:
                    seen = first_point <= u < first_crossing
                elif v < first_point:
                    seen = u >= first_crossing and lengths[e] * resolution < NEAR
                else:
                    seen = sees(body, anchors, each, u, here, anchor, bend)
                if not seen:
                    reached, bent = labels[label].distance + lengths[e], label
                    if reached >= limit:
                        continue
                leave(head, labels, room)
                labels[room].joint, anchors[room] = joint, bent
                labels[room].distance = reached
                least[v] = min(least[v], reached)
                join(head, labels, max(bucket_of(head, scale, reached - origin), bucket), room)
