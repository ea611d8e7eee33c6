"""Any-angle paths through the body: distances that converge to the geodesic ones.

Paths along lattice edges are too long however fine the lattice: in free space by 50 % on average
with 6 neighbours, by 9 % with 26. Here the label of a node has a parent vertex, where its path
bends last, and its distance is that of the parent plus the straight line from there. This is
any-angle path planning (Theta*: Daniel, Nash, Koenig & Felner 2010) on the cut-cell graph, with
whole bones as first parents: what has line of sight to a bone gets its exact distance to the
segment.

Wavefronts of all joints propagate together, and a node has labels (joint, distance, parent) for its
nearest few joints only. In a graph nothing is lost by that: if k joints are nearer to a node than a
further one, they are also nearer to whatever that one would reach through the node. So the work
grows with the labels of a node, not with the joints. The sources are partitioned in two, for two
threads: about as many of the joints around a node are in the one part as in the other.

The graph is contracted first, see `contraction.py`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...bones.bones import Bones, Sources
from ...geometry.vectors import TIE
from ...graph import CutCellGraph
from ...runtime.compiled import no_refcount
from ...runtime.progress import Progress, Shares, Tell, silent
from ...runtime.threads import in_threads
from .contraction import Contraction
from .labels import (
    BEFORE_ALL,
    END,
    SETTLED,
    UNUSED_JOINT,
    bucket_of,
    find_room,
    has_parent,
    join,
    leave,
    limit_of,
    move_on,
    settle_equals,
    sort,
)
from .line_of_sight import body_of, has_line_of_sight, is_preferred, parent_position, straight
from .wavefront import Ranking, Wavefront, begin, enqueue, partition_sources, rank_bones

CORNER_CELLS = 2
"""Lattice cells: how near a corner of a triangle must be to have line of sight to a parent. A
distant one may lie behind a fold of the surface."""
ON_BONE = 0.5
"""Lattice cells: smallest distance of the nearest joint that others are compared with."""
BUCKETS = 4
"""Buckets for a unit of distance, times R squared: each is at most a hundredth of a cell wide."""
SPAN = 1
"""Units of distance that the buckets cover at a time."""
LABELS_TOGETHER = 25_000
"""Labels that are settled in a few hundredths of a second: then progress is reported."""


def any_angle_paths(
    graph: CutCellGraph,
    contraction: Contraction,
    sources: Sources,
    bones: Bones,
    targets: NDArray[np.int32],
    nearest: int | None = None,
    within: float = np.inf,
    least: NDArray[np.float64] | None = None,
    progress: Progress = silent,
) -> csr_array:
    """Compute the length of the shortest any-angle path from each joint to each node.

    Shapes: targets (t,), least (K,); returns rows (t, j) of the joints that reach a node.
    """
    ranking = rank_bones(graph, contraction, bones, sources)
    count = len(ranking.joints)
    if nearest is not None and least is not None:
        groups = [np.ones(count, np.bool_)]
    elif nearest is not None and nearest < count:
        groups = partition_sources(ranking.places)
    else:  # one by one, so the nearest joint is not known
        nearest, within = 1, np.inf
        groups = list(np.eye(count, dtype=np.bool_))
    number = np.argsort(np.argsort(ranking.joints))
    shape = len(targets), len(groups) * nearest
    joint, distance = np.empty(shape, np.int32), np.empty(shape)
    shares = Shares(progress, "distances", len(groups))
    body = body_of(graph, contraction)

    def propagate(share: int) -> None:
        front = begin(ranking, len(contraction.node), groups[share], nearest, least)
        _propagate(body, contraction, ranking, front, within, lambda done: shares.tell(share, done))
        shares.tell(share, 1.0)
        labels, column = (front.labels, front.parents, nearest), share * nearest
        _read(graph.nodes, body, ranking.table, *labels, targets, number, column, joint, distance)

    in_threads(propagate, range(len(groups)))
    is_near = distance < np.inf
    if within < np.inf and least is None:  # each part compared its own joints only
        nearest_distance = np.maximum(distance.min(axis=1), ON_BONE / graph.lattice.resolution)
        is_near &= distance <= (within * nearest_distance + TIE)[:, None]
    start = np.append(0, np.cumsum(is_near.sum(axis=1)))
    rows = csr_array((distance[is_near], joint[is_near], start), (len(targets), count))
    rows.sort_indices()
    return rows


def least_distances(
    graph: CutCellGraph,
    contraction: Contraction,
    sources: Sources,
    bones: Bones,
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Compute the distance of the nearest joint to each uncontracted node, shape (K,)."""
    ranking = rank_bones(graph, contraction, bones, sources)
    every = np.ones(len(ranking.joints), np.bool_)
    front = begin(ranking, len(contraction.node), every, 1)
    body = body_of(graph, contraction)
    _propagate(body, contraction, ranking, front, np.inf, lambda done: progress("distances", done))
    return front.least


def _propagate(
    body: tuple,
    contraction: Contraction,
    ranking: Ranking,
    front: Wavefront,
    within: float,
    report: Tell,
) -> None:
    """Settle all labels."""
    labels = front.labels
    scale = float(BUCKETS * body[0] ** 2)
    head = np.full(int(SPAN * scale), END, np.int32)
    enqueue(labels, front.each, head, scale, contraction.node, contraction.number)
    adjacency = contraction.indptr, contraction.indices
    ahead = np.empty(int(np.diff(adjacency[0]).max()) + 1, np.int64)
    space, queue = (adjacency, body, ranking.table), (head, scale, ahead)
    wavefront = front.each, labels, front.parents, front.least
    last, origin, bucket, settled = len(head) - 1, 0.0, 0, 0
    while True:
        bucket, count = _settle(space, wavefront, queue, within, origin, bucket, LABELS_TOGETHER)
        settled += count
        report(min(settled / len(labels), 0.99))
        if bucket == last:
            if head[last] == END:
                return
            origin, bucket = move_on(head, scale, labels), 0


@no_refcount
def _read(nodes, body, bones, labels, parents, each, targets, number, column, joint, distance):
    """Write the joints and distances of some nodes of the graph, from a column on.

    `number` holds the number of each joint by rank. A contracted node has line of sight to the
    parents of its representative.
    """
    _, _, _, places, (_, node, uncontracted), _ = body
    for t in range(len(targets)):
        target, v = targets[t], uncontracted[targets[t]]
        position = nodes[target, 0], nodes[target, 1], nodes[target, 2]
        for k in range(each):
            label = v * each + k
            reached, parent = labels[label].distance, parents[label]
            if labels[label].joint != UNUSED_JOINT and node[v] != target:
                reached = straight(position, parent_position(places, bones, each, parent, position))
                reached += labels[parent].distance if parent >= 0 else 0.0
            joint[t, column + k] = number[max(labels[label].joint, 0)]
            distance[t, column + k] = reached


@no_refcount
def _settle(space, wavefront, queue, within, origin, bucket, most):
    """Settle about `most` labels by distance, bucket by bucket, except the last bucket.

    The queue's buckets begin at `origin`, and it has a workspace for a node's neighbours. Returns
    the bucket to continue with, and how many labels have been settled.
    """
    (indptr, indices), body, bones = space
    (each, labels, parents, least), (head, scale, ahead) = wavefront, queue
    resolution, first_point, first_surface, nodes, _, _ = body
    on_bone, settled, label = ON_BONE / resolution, 0, END
    while bucket < len(head) - 1 and settled < most:
        sort(head, labels, bucket)
        while label != END or (head[bucket] != END and settled < most):
            # Equals are settled together: otherwise one could improve another if it came first.
            label = settle_equals(head, labels, bucket) if label == END else label
            settled += 1
            u, joint, grandparent = label // each, labels[label].joint, parents[label]
            final = labels[label].distance - TIE
            to_grandparent = labels[grandparent].distance if grandparent >= 0 else 0.0
            # Most neighbours have this parent already. A branch on that would be mispredicted.
            count = 0
            for e in range(indptr[u], indptr[u + 1]):
                ahead[count] = indices[e]
                count += not has_parent(parents, each, indices[e], grandparent)
            for k in range(count):
                v = ahead[k]
                slot = find_room(labels, each, v, joint)
                if labels[slot].after == SETTLED:
                    continue
                limit, other = limit_of(labels, slot, joint), parents[slot]
                position = nodes[v, 0], nodes[v, 1], nodes[v, 2]
                start = parent_position(nodes, bones, each, grandparent, position)
                reached, parent = to_grandparent + straight(position, start), grandparent
                bound = within * max(least[v], on_bone) + TIE
                if reached >= limit or reached > bound:
                    continue  # a path by way of u is no shorter
                step = straight(position, (nodes[u, 0], nodes[u, 1], nodes[u, 2]))
                if min(u, v) < first_point:
                    sees = u >= first_point and step * resolution < CORNER_CELLS - TIE
                elif v >= first_surface:
                    sees = u < first_surface
                else:
                    sees = has_line_of_sight(
                        body, labels, parents, each, u, v, position, grandparent, start, final
                    )
                if not sees:
                    reached, parent = labels[label].distance + step, label
                    if reached >= limit:
                        continue
                is_tie = labels[slot].joint == joint and reached >= limit - 2 * TIE
                if is_tie and not is_preferred(body, bones, labels, each, parent, other, position):
                    continue
                leave(head, labels, slot)
                labels[slot].joint, parents[slot] = joint, parent
                labels[slot].distance = reached
                least[v] = min(least[v], reached)
                later = max(bucket_of(head, scale, reached - origin), bucket)
                join(head, labels, later, slot, reached if later == bucket else BEFORE_ALL)
            label = labels[label].before
        bucket += head[bucket] == END
    return bucket, settled
