"""Straight paths through the body: distances that converge to the geodesic ones.

Paths along lattice edges are too long however fine the lattice: in free space by 50 % on
average with 6 neighbours, by 9 % with 26. Here each node remembers its anchor, the last bend
of its path, and its distance is that of the anchor plus the straight way from there. This
is any-angle path planning (Theta*: Daniel, Nash, Koenig & Felner 2010) on the cut-cell graph, with
the whole bone as first anchor: what sees the bone has its exact distance to the segment.

Dijkstra's order makes seeing cheap. Nodes nearer to the anchor are settled first, so a
lattice point sees the anchor when the neighbour that the line of sight passes next to does.
Where that neighbour follows another anchor, the line itself is walked.

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

from ..graph import CutCellGraph
from ..graph.interior import OUTSIDE, point_number
from ..progress import Progress, silent
from ..threads import in_threads, threads
from .bones import TIE, Bones, Sources
from .queue import END, SETTLED, bucket_of, bucket_queue, join, leave, move_on

NOBODY, NOTHING = -1, -(2**31)
"""The joint and the anchor of a label that is not there."""
NEAR = 2
"""Lattice cells. A far corner of a triangle may lie behind a bend of the surface."""
AT_ONCE = 4
"""Joints that spread together where all are wanted everywhere."""
FINENESS = 4
"""Times R squared: buckets a unit of distance. One is a hundredth of a cell wide, or less."""
SPAN = 1
"""Units of distance that the buckets cover at a time."""
PAUSES = 8
"""How often a unit of distance is interrupted, to report and to be cancelled."""


def any_angle_paths(
    graph: CutCellGraph,
    sources: Sources,
    bones: Bones,
    targets: NDArray[np.int32],
    nearest: int | None = None,
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
    progress : callable
        Called with the stage "distances".

    Returns
    -------
    array, shape (j, t), float64
        For the joints with bones, ascending. Infinite where no path leads and for joints that
        are not among the nearest.
    """
    joints = np.unique(bones.joint)
    if nearest is not None and nearest < len(joints):
        groups = [joints]
    else:
        nearest = min(AT_ONCE, len(joints))
        groups = [joints[k : k + nearest] for k in range(0, len(joints), nearest)]
    body = _body(graph)
    result = np.full((len(joints), len(targets)), np.inf)

    def spread(group: NDArray[np.int32]) -> None:
        report = progress if len(groups) == 1 else silent
        front = _start(graph, sources, bones, group, nearest)
        ranked, distance = _spread(graph, body, front, report)
        ranked, distance = ranked[targets], distance[targets]
        at, slot = np.nonzero(ranked != NOBODY)
        row = np.searchsorted(joints, front.joints[ranked[at, slot]])
        result[row, at] = distance[at, slot]

    if len(groups) == 1:
        spread(groups[0])
    else:
        step = 4 * threads()
        for first in range(0, len(groups), step):
            progress("distances", first / len(groups))
            in_threads(spread, groups[first : first + step])
    progress("distances", 1.0)
    return result


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
    labels : tuple
        k; the rank, distance and anchor of label s of node v at v * k + s. An anchor is the
        label of the node where the path bends last, or ~bone.
    queue : tuple
        See `bucket_queue`.
    """

    joints: NDArray[np.int32]
    bones: NDArray[np.float64]
    labels: tuple
    queue: tuple


def _start(
    graph: CutCellGraph, sources: Sources, bones: Bones, group: NDArray, each: int
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

    count = len(graph.nodes) * each
    labels = (
        each,
        np.full(count, NOBODY, np.int32),
        np.full(count, np.inf),
        np.full(count, NOTHING, np.int32),
    )
    scale = FINENESS * graph.lattice.resolution**2
    queue = bucket_queue(count, SPAN * scale, scale)
    first_distance = sources.distance[chosen]
    _enter_sources(labels, queue, sources.node[chosen], bone[chosen], rank, first_distance)
    table = np.concatenate([start, way, inverse[:, None]], axis=1)
    return _Front(joints[by_place], table, labels, queue)


def _body(graph: CutCellGraph) -> tuple:
    first_point = int(graph.vertex_node.max()) + 1
    first_crossing = first_point + len(graph.interior)
    resolution = graph.lattice.resolution
    return (
        resolution,
        first_point,
        first_crossing,
        graph.nodes,
        graph.interior.table,
        graph.whole,
    )


def _spread(
    graph: CutCellGraph, body: tuple, front: _Front, progress: Progress
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Settle all labels; return the ranks and distances of each node's, both (N, k)."""
    each, rank, distance, _ = front.labels
    scale, head = front.queue[:2]
    step = len(head) // (SPAN * PAUSES)
    waiting, origin = True, 0.0
    while waiting:
        for bucket in range(0, len(head) - 1, step):
            progress("distances", min(origin + bucket / scale, 0.99))
            last = min(bucket + step, len(head) - 1)
            waiting = _settle(
                graph.adjacency, body, front.bones, front.labels, front.queue, origin, bucket, last
            )
            if not waiting:
                break
        else:
            origin = move_on(front.queue, distance)
    return rank.reshape(-1, each), distance.reshape(-1, each)


@njit(cache=True)
def _enter_sources(labels, queue, node, bone, rank, first_distance):
    each, joint, distance, anchor = labels
    scale, head, after, before = queue
    for s in range(len(node)):
        j, a = rank[bone[s]], ~bone[s]
        slot = _slot(each, joint, distance, anchor, node[s], j, a)
        if slot >= 0 and first_distance[s] < distance[slot]:
            leave(head, after, before, slot)
            joint[slot], distance[slot], anchor[slot] = j, first_distance[s], a
            join(head, after, before, bucket_of(head, scale, first_distance[s]), slot)


@njit(cache=True, inline="always")
def _slot(each, joint, distance, anchor, v, j, a):
    """Return where node v keeps the label of joint j or, if it has none, its farthest label.

    -1 if v follows the anchor a already.
    """
    farthest = v * each
    for slot in range(v * each, v * each + each):
        if anchor[slot] == a:
            return -1
        if joint[slot] == j:
            return slot
        if distance[slot] > distance[farthest]:
            farthest = slot
    return farthest


@njit(cache=True, nogil=True)
def _settle(adjacency, body, bones, labels, queue, origin, first, last):
    """Settle labels by distance, bucket after bucket; tell whether any are left beyond."""
    indptr, indices, lengths = adjacency
    resolution, first_point, first_crossing, nodes, _, _ = body
    each, joint, distance, anchor = labels
    scale, head, after, before = queue
    for bucket in range(first, last):
        while head[bucket] != END:
            label = head[bucket]
            d = distance[label]
            leave(head, after, before, label)
            after[label] = SETTLED
            u, j, a = label // each, joint[label], anchor[label]
            to_anchor = distance[a] if a >= 0 else 0.0
            for e in range(indptr[u], indptr[u + 1]):
                v = indices[e]
                slot = _slot(each, joint, distance, anchor, v, j, a)
                if slot < 0 or after[slot] == SETTLED:
                    continue
                # Of joints equally near, the first by position stays.
                limit = distance[slot]
                if joint[slot] != j:
                    limit *= 1 + TIE if j < joint[slot] else 1 - TIE
                here = nodes[v, 0], nodes[v, 1], nodes[v, 2]
                bend = _bend(nodes, bones, each, a, here)
                reached = to_anchor + _straight(here, bend)
                if reached >= limit:
                    continue  # a bend at u would be no shorter
                # Off the lattice, what is one step from a lattice point that sees the bend does,
                # too: a crossing, and from there a corner of its triangle if it is near.
                if v >= first_crossing:
                    seen = first_point <= u < first_crossing
                elif v < first_point:
                    seen = u >= first_crossing and lengths[e] * resolution < NEAR
                else:
                    seen = _sees(body, each, anchor, u, here, a, bend)
                new_anchor = a
                if not seen:
                    new_anchor = label
                    reached = d + lengths[e]
                    if reached >= limit:
                        continue
                leave(head, after, before, slot)
                joint[slot], distance[slot], anchor[slot] = j, reached, new_anchor
                join(
                    head, after, before, max(bucket_of(head, scale, reached - origin), bucket), slot
                )
    return (head[last:] != END).any()


@njit(cache=True, inline="always")
def _bend(nodes, bones, each, a, here):
    """Return the place of anchor a; of a bone, the point nearest to here."""
    if a >= 0:
        n = a // each
        return nodes[n, 0], nodes[n, 1], nodes[n, 2]
    b = ~a
    x, y, z = bones[b, 0], bones[b, 1], bones[b, 2]
    ex, ey, ez, inverse = bones[b, 3], bones[b, 4], bones[b, 5], bones[b, 6]
    along = (here[0] - x) * ex + (here[1] - y) * ey + (here[2] - z) * ez
    t = min(max(along * inverse, 0.0), 1.0)
    return x + t * ex, y + t * ey, z + t * ez


@njit(cache=True, inline="always")
def _straight(p, q):
    x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return np.sqrt(x * x + y * y + z * z)


@njit(cache=True, inline="always")
def _sees(body, each, anchor, u, here, a, bend):
    """Tell whether the straight way from the bend to a lattice point stays inside.

    It does from the node u beside that point.
    """
    resolution, first_point, _, _, table, whole = body
    x, y, z = int(here[0] * resolution), int(here[1] * resolution), int(here[2] * resolution)
    dx = bend[0] * resolution - 0.5 - x
    dy = bend[1] * resolution - 0.5 - y
    dz = bend[2] * resolution - 0.5 - z
    far = max(abs(dx), abs(dy), abs(dz))
    if far > 1:
        sx, sy, sz = int(np.rint(dx / far)), int(np.rint(dy / far)), int(np.rint(dz / far))
        w = _point(table, resolution, x + sx, y + sy, z + sz)
        if w != OUTSIDE:
            w += first_point
            if w == u:
                return True
            follows = a >= 0 and w == a // each
            for slot in range(w * each, w * each + each):
                follows |= anchor[slot] == a
            # Across a gap thinner than a cell the next point is no neighbour.
            if follows and _walk(table, whole, resolution, (x, y, z), (x + sx, y + sy, z + sz)):
                return True
    cell = int(bend[0] * resolution), int(bend[1] * resolution), int(bend[2] * resolution)
    return _walk(table, whole, resolution, (x, y, z), cell)


@njit(cache=True, inline="always")
def _point(table, resolution, x, y, z):
    if not (0 <= x < resolution and 0 <= y < resolution and 0 <= z < resolution):
        return np.int64(OUTSIDE)
    return point_number(table[0], table[1], table[2], table[3], x * resolution + y, z)


@njit(cache=True)
def _walk(table, whole, resolution, cell, goal):
    """Tell whether the cells along a line are joined by edges inside (Amanatides & Woo 1987)."""
    x, y, z = cell
    dx, dy, dz = abs(goal[0] - x), abs(goal[1] - y), abs(goal[2] - z)
    sx, sy, sz = np.sign(goal[0] - x), np.sign(goal[1] - y), np.sign(goal[2] - z)
    # When the line leaves the cell on either side, as a fraction of the way.
    tx = 0.5 / dx if dx else np.inf
    ty = 0.5 / dy if dy else np.inf
    tz = 0.5 / dz if dz else np.inf
    p = _point(table, resolution, x, y, z)
    for _ in range(dx + dy + dz):
        if tx <= ty and tx <= tz:
            axis, step = 0, sx
            x += sx
            tx += 1 / dx
        elif ty <= tz:
            axis, step = 1, sy
            y += sy
            ty += 1 / dy
        else:
            axis, step = 2, sz
            z += sz
            tz += 1 / dz
        q = _point(table, resolution, x, y, z)
        if q == OUTSIDE or not whole[axis, p if step > 0 else q]:
            return False
        p = q
    return True
