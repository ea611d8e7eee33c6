"""Straight paths through the body: distances that converge to the geodesic ones.

Paths along lattice edges are too long however fine the lattice: in free space by 50 % on
average with 6 neighbours, by 9 % with 26. Here each node remembers its anchor, the last bend
of its path, and its distance is that of the anchor plus the straight way from there. This
is any-angle path planning (Theta*: Daniel, Nash, Koenig & Felner 2010) on the cut-cell graph, with
the whole bone as first anchor: what sees the bone has its exact distance to the segment.

Joints spread together, and a node has room for the labels (joint, distance, anchor) of
its nearest few alone. Nothing is lost by that: where k joints are nearer to a node than a
further one, they are also nearer to whatever that one would reach by way of the node. So the
work grows with the labels that a vertex keeps, not with the joints. It is done in two halves,
side by side: of the joints around a node about as many are in the one as in the other.

Crossings next to a lattice point are passed over (`graph.contracted`): they see what it sees. So
are seven of eight points deep inside, which would say the same as the eighth.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..compiled import lean
from ..graph import CutCellGraph
from ..progress import Progress, Shares, silent
from ..threads import in_threads, parts, threads
from .bones import TIE, Bones, Sources
from .front import Front, Ranking, begin, in_halves, line_up, rank_bones
from .labels import NOBODY, find_room, follows_anchor
from .queue import END, SETTLED, bucket_of, join, leave, move_on
from .sight import bend_of, body_of, sees, straight

NEAR = 2
"""Lattice cells. A far corner of a triangle may lie behind a bend of the surface."""
ON_BONE = 0.5
"""Lattice cells: of what is as near as this, no joint is told to be so many times nearer."""
FINENESS = 4
"""Times R squared: buckets a unit of distance. One is a hundredth of a cell wide, or less."""
SPAN = 1
"""Units of distance that the buckets cover at a time."""
ROOMS = 1, 3
"""Labels a node for which the kernel is compiled with their number built in, a third faster."""
A_WHILE = 25_000
"""Labels that are settled in a few hundredths of a second: then progress is told."""
A_PART = 2_000_000
"""Distances that are looked at in less than a tenth of a second."""


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
        k: a node gets the distances of its k nearest joints and, unless `least` is given, of at
        most as many others; of all when left out.
    within : float
        Where only some joints are measured, leave out what is so many times as far as the
        nearest; half a lattice cell counts as the nearest that one can be.
    least : array, shape (K,), optional
        What `least_distances` returns, where the nearest joint may be none of these bones'.
    progress : callable
        Called with the stage "distances".

    Returns
    -------
    array, shape (j, t), float64
        For the joints with bones, ascending. Infinite where no path leads and for joints that
        are not among the nearest.
    """
    ranking = _ranked(graph, bones, sources)
    count = len(ranking.joints)
    if nearest is not None and least is not None:
        groups = [np.ones(count, np.bool_)]
    elif nearest is not None and nearest < count:
        groups = in_halves(ranking.places)
    else:  # each by itself, which does not tell who is nearest
        nearest, within = 1, np.inf
        groups = list(np.eye(count, dtype=np.bool_))
    row = np.argsort(np.argsort(ranking.joints))
    result = np.full((count, len(targets)), np.inf)
    shares = Shares(progress, "distances", len(groups))

    def spread(share: int) -> None:
        front = begin(ranking, len(graph.contracted.node), groups[share], nearest, least)
        _spread(graph, ranking, front, within, lambda done: shares.tell(share, done))
        shares.tell(share, 1.0)
        labels = front.labels, front.anchors, nearest
        _read(graph.nodes, body_of(graph), ranking.table, *labels, targets, row, result)

    in_threads(spread, range(len(groups)))
    if within < np.inf and least is None:  # either half knew of its own joints alone
        near = ON_BONE / graph.lattice.resolution
        in_threads(
            lambda part: _leave_out(within, near, result[:, part]),
            parts(len(targets), threads() + result.size // A_PART),
            lambda done: progress("distances", 1.0),
        )
    return result


def least_distances(
    graph: CutCellGraph, sources: Sources, bones: Bones, progress: Progress = silent
) -> NDArray[np.float64]:
    """Compute how far the nearest joint is from each node that is not passed over, shape (K,)."""
    ranking = _ranked(graph, bones, sources)
    every = np.ones(len(ranking.joints), np.bool_)
    front = begin(ranking, len(graph.contracted.node), every, 1)
    _spread(graph, ranking, front, np.inf, lambda done: progress("distances", done))
    return front.least


def _ranked(graph: CutCellGraph, bones: Bones, sources: Sources) -> Ranking:
    number = graph.contracted.number[sources.node]
    return rank_bones(bones, Sources(number, sources.bone, sources.distance))


def _spread(
    graph: CutCellGraph,
    ranking: Ranking,
    front: Front,
    within: float,
    tell: Callable[[float], None],
) -> None:
    """Settle all labels."""
    labels = front.labels
    rooms = (0,) * front.each if front.each in ROOMS else np.empty(front.each)
    scale = float(FINENESS * graph.lattice.resolution**2)
    head = np.full(int(SPAN * scale), END, np.int32)
    line_up(labels, head, scale)
    adjacency = graph.contracted.indptr, graph.contracted.indices
    ahead = np.empty(int(np.diff(adjacency[0]).max()) + 1, np.int64)
    known = adjacency, body_of(graph), ranking.table, within
    given = *known, rooms, labels, front.anchors, front.least, head, scale, ahead
    last, origin, settled = len(head) - 1, 0.0, 0
    bucket = 0
    while True:
        bucket, count = _settle(*given, origin, bucket, A_WHILE)
        settled += count
        tell(min(settled / len(labels), 0.99))
        if bucket == last:
            if head[last] == END:
                return
            origin, bucket = move_on(head, scale, labels), 0


@lean
def _read(nodes, body, bones, labels, anchors, each, targets, row, distance):
    """Write the distances at some nodes of the graph; `row` tells which row is a joint's.

    What was passed over sees the bends that are seen by what stands for it.
    """
    _, _, _, places, (_, node, number) = body
    for t in range(len(targets)):
        target, v = targets[t], number[targets[t]]
        here = nodes[target, 0], nodes[target, 1], nodes[target, 2]
        for label in range(v * each, v * each + each):
            if labels[label].joint == NOBODY:
                continue
            reached, anchor = labels[label].distance, anchors[label]
            if node[v] != target:
                reached = straight(here, bend_of(places, bones, each, anchor, here))
                reached += labels[anchor].distance if anchor >= 0 else 0.0
            distance[row[labels[label].joint], t] = reached


@lean
def _leave_out(within, near, distance):
    """Forget what is more than so many times as far as the nearest, which is at least `near`."""
    for t in range(distance.shape[1]):
        least = np.inf
        for j in range(len(distance)):
            least = min(least, distance[j, t])
        for j in range(len(distance)):
            if distance[j, t] > within * max(least, near):
                distance[j, t] = np.inf


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
    bucket,
    most,
):
    """Settle labels by distance, bucket after bucket but for the last; about `most` of them.

    `rooms` has as many entries as a node has labels; `ahead` is room for a node's edges.
    Returns the bucket to go on with, and how many labels have been settled.
    """
    each = len(rooms)
    indptr, indices = adjacency
    resolution, first_point, first_crossing, nodes, _ = body
    settled = 0
    while bucket < len(head) - 1 and settled < most:
        while head[bucket] != END and settled < most:
            settled += 1
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
                beside = straight(here, (nodes[u, 0], nodes[u, 1], nodes[u, 2]))
                if u < first_point:
                    seen = False
                elif v < first_point:
                    seen = beside * resolution < NEAR
                elif v >= first_crossing:
                    seen = u < first_crossing
                else:
                    seen = sees(body, anchors, each, u, v, here, anchor, bend)
                if not seen:
                    reached, bent = labels[label].distance + beside, label
                    if reached >= limit:
                        continue
                leave(head, labels, room)
                labels[room].joint, anchors[room] = joint, bent
                labels[room].distance = reached
                least[v] = min(least[v], reached)
                join(head, labels, max(bucket_of(head, scale, reached - origin), bucket), room)
        bucket += head[bucket] == END
    return bucket, settled
