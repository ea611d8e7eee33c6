"""Features of pairs of a vertex and a near joint, from data that the rules compute."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geodesics.bones import TIE
from ...geometry.vectors import segment_fraction
from ...method import RIG_REACH
from ...rig import Skeleton
from ...rig.names import words
from ...runtime.compiled import compiled
from ..rig_falloff.division import MIN_CELLS, Division, _facing

NEAR = 5
"""Number of the nearest joints of a vertex that are distinguished."""
FARTHEST = 100.0
"""Largest ratio, also used for infinite and missing ones."""
WORDS = (
    "head skull", "jaw mouth chin lip teeth tongue", "eye lid brow", "neck",
    "spine chest hips pelvis torso abdomen body stomach waist belly rib",
    "hand wrist palm", "finger thumb index middle ring pinky",
    "arm shoulder clavicle collar elbow", "foot toe ankle heel", "leg thigh knee shin calf hip",
    "tail", "wing fin feather", "hair hat cape cloth skirt ear horn weapon sword prop",
)  # fmt: skip
"""Parts of names that mean about the same thing."""
FEATURES = (
    "distance / nearest", "distance / other", "effective / least", "effective / other",
    "rank", "effective rank", "straight / distance", "facing", "share", "spread share",
    "spread / largest", "along bone", "beyond bone", "beside bone", "bone length",
    "distance / bone length", "distance", "children", "depth", "hops", "kinship", "containment",
    "component's area", "component's vote", "component's joints", "distance / radius",
    "joint's area", "spread of parent", "spread of children", "word", "nearest's word",
)  # fmt: skip
"""Names of the features of a pair, in order."""


class Pairs(NamedTuple):
    """Pairs of a vertex and a near joint: vertex (p,) ascending, joint (p,), features (p, f)."""

    vertex: NDArray[np.int32]
    joint: NDArray[np.int32]
    features: NDArray[np.float32]


def pair_features(division: Division, spread: NDArray[np.float64], skeleton: Skeleton) -> Pairs:
    """Compute the features of all pairs; `spread` (k, j) are the division's weights, diffused."""
    distances, surface, weights = division.distances, division.surface, division.weights
    joints, count = distances.at_welded.shape
    bones, areas = distances.bones, surface.areas / max(surface.areas.sum(), 1e-300)
    votes = np.zeros(division.containment.shape)
    np.add.at(votes, (surface.component, weights.argmax(axis=1)), areas)
    area = votes.sum(axis=1, keepdims=True)
    children = np.bincount(
        skeleton.parents[(skeleton.parents >= 0) & skeleton.deform], minlength=joints
    )
    of_joint = np.column_stack(
        [
            division.radius,
            children,
            skeleton.depth / max(1, int(skeleton.depth.max())),
            areas @ weights,
            [word_code(name) for name in skeleton.names],
        ]
    )
    of_component = np.stack(
        [division.containment, np.broadcast_to(area, votes.shape), votes / np.maximum(area, 1e-300)]
    )
    child = np.argsort(skeleton.parents, kind="stable")
    vertex, joint = np.empty((2, count * NEAR), np.int32)
    features = np.empty((count * NEAR, len(FEATURES)), np.float32)
    found = _pair_features(
        surface.points,
        surface.normals,
        surface.component,
        distances.at_welded,
        division.penalty,
        weights,
        spread,
        np.searchsorted(bones.joint, np.arange(joints + 1)),
        bones.start,
        bones.end,
        MIN_CELLS / distances.graph.lattice.resolution,
        skeleton.parents.astype(np.int64),
        skeleton.depth.astype(np.int64),
        child,
        np.searchsorted(skeleton.parents[child], np.arange(joints + 1)),
        of_joint,
        of_component,
        np.count_nonzero(division.containment, axis=1).astype(np.float64),
        vertex,
        joint,
        features,
    )
    return Pairs(vertex[:found], joint[:found], features[:found])


def word_code(name: str) -> int:
    """Return which of `WORDS` a joint's name contains, from 1; 0 if none."""
    found = words(name)
    for code, group in enumerate(WORDS, 1):
        if any(part in word for part in group.split() for word in found):
            return code
    return 0


@compiled
def _nearest(distance, vertex, depth, joints):
    """Write the nearest joints of a vertex, ascending; return how many there are.

    Among joints at one distance, as where bones meet, the one nearer to the root comes first.
    """
    count = 0
    for j in range(len(distance)):
        d = distance[j, vertex]
        if d == np.inf:
            continue
        k = count
        while k > 0:
            before = distance[joints[k - 1], vertex]
            if before < d * (1 - TIE) or (
                before <= d * (1 + TIE) and depth[joints[k - 1]] <= depth[j]
            ):
                break
            if k < NEAR:
                joints[k] = joints[k - 1]
            k -= 1
        if k < NEAR:
            joints[k] = j
            count = min(count + 1, NEAR)
    least = max(distance[joints[0], vertex], 1e-3)
    while count > 1 and distance[joints[count - 1], vertex] > RIG_REACH * least:
        count -= 1
    return count


@compiled
def _kinship(a, b, parents, depth):
    """Return the steps in the tree from a to b, and 1 for up only, 2 for down only, 3 for both."""
    up, down = 0, 0
    while a != b:
        if a < 0 or b < 0:
            return 50.0, 4.0
        if depth[a] >= depth[b]:
            a, up = parents[a], up + 1
        else:
            b, down = parents[b], down + 1
    return float(up + down), float((up > 0) + 2 * (down > 0))


@compiled
def _pair_features(
    points, normals, component, distance, penalty, weights, spread, bone, start, end, near,
    parents, depth, child, first_child, of_joint, of_component, bones_inside,
    vertex, joint, features,
):  # fmt: skip
    """Fill the arrays of `Pairs`; return how many there are."""
    joints, effective = np.empty(NEAR, np.int64), np.empty(NEAR)
    pair = 0
    for v in range(len(points)):
        count, c = _nearest(distance, v, depth, joints), component[v]
        largest = 1e-12
        for k in range(count):
            j = joints[k]
            d = max(distance[j, v], near)
            facing = _facing(points[v], normals[v], start, end, bone[j], bone[j + 1])
            effective[k] = penalty[c, j] * d * max(1.0, d / of_joint[j, 0]) / facing
            largest = max(largest, spread[v, j])
        for k in range(count):
            j, row = joints[k], features[pair]
            d = max(distance[j, v], near)
            other, other_effective, rank, least = np.inf, np.inf, 0, np.inf
            nearer = 0
            for i in range(count):
                least = min(least, effective[i])
                if i != k:
                    other = min(other, max(distance[joints[i], v], near))
                    other_effective = min(other_effective, effective[i])
                    rank += effective[i] < effective[k]
                    nearer += distance[joints[i], v] < distance[j, v] * (1 - TIE)
            row[0] = d / max(distance[joints[0], v], near)
            row[1] = d / other if other < np.inf else 0.0
            row[2] = effective[k] / least
            row[3] = effective[k] / other_effective if other_effective < np.inf else 0.0
            row[4], row[5] = nearer, rank
            nearest, t_nearest, b_nearest = np.inf, 0.0, bone[j]
            for b in range(bone[j], bone[j + 1]):
                t = segment_fraction(start[b], end[b], points[v])
                squared = 0.0
                for a in range(3):
                    away = points[v, a] - start[b, a] - t * (end[b, a] - start[b, a])
                    squared += away * away
                if squared < nearest:
                    nearest, b_nearest = squared, b
            length, dot = 0.0, 0.0
            for a in range(3):
                along = end[b_nearest, a] - start[b_nearest, a]
                length += along * along
                dot += along * (points[v, a] - start[b_nearest, a])
            length = np.sqrt(length)
            t_nearest = dot / length if length > 1e-9 else 0.0
            row[6] = np.sqrt(nearest) / d
            row[7] = _facing(points[v], normals[v], start, end, bone[j], bone[j + 1])
            row[8], row[9], row[10] = weights[v, j], spread[v, j], spread[v, j] / largest
            row[11] = t_nearest / length if length > 1e-9 else 0.0
            row[12] = max(t_nearest - length, -t_nearest, 0.0) / d
            row[13] = t_nearest / d
            row[14], row[15], row[16] = length, d / max(length, near), d
            row[17], row[18] = of_joint[j, 1], of_joint[j, 2]
            row[19], row[20] = _kinship(j, joints[0], parents, depth)
            row[21], row[22], row[23] = (
                of_component[0, c, j], of_component[1, c, j], of_component[2, c, j],
            )  # fmt: skip
            row[24], row[25] = bones_inside[c], d / of_joint[j, 0]
            row[26] = of_joint[j, 3]
            row[27] = spread[v, parents[j]] if parents[j] >= 0 else 0.0
            row[28] = 0.0
            for i in range(first_child[j], first_child[j + 1]):
                row[28] += spread[v, child[i]]
            row[29], row[30] = of_joint[j, 4], of_joint[joints[0], 4]
            for f in range(len(row)):
                row[f] = min(row[f], FARTHEST)
            vertex[pair], joint[pair] = v, j
            pair += 1
    return pair
