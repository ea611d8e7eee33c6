"""Make the weights of a mirrored character mirrored."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from ..errors import MeshError
from ..geometry.weld import WELD_TOLERANCE, weld
from ..rig import Rig, Skeleton

VERTEX_TOLERANCE = 1e-3
"""Maximum distance of a vertex's partner from its mirror image, in bounding-box diagonals."""

JOINT_TOLERANCE = 3e-2
"""The same for joints, which artists place by eye."""

MIN_SHARE = 0.5
"""Minimum share of vertices with a partner for a character to count as mirrored."""


@dataclass(frozen=True, eq=False)
class Mirror:
    """A plane of symmetry, and the mirror image of each vertex and joint; -1 for none."""

    axis: int  # 0, 1, 2: the plane is orthogonal to x, y or z
    position: float  # where the plane cuts the axis, in the file's units
    vertex: NDArray[np.intp]  # (n,), itself on the plane
    joint: NDArray[np.intp]  # (j,)


def find_mirror(rig: Rig) -> Mirror:
    """Find the plane, orthogonal to x, y or z, across which most vertices have a partner."""
    used = np.zeros(len(rig.mesh.vertices), bool)
    used[rig.mesh.faces] = True
    best, share = None, 0.0
    # Welded vertices: copies of a vertex at a seam must all get the same partner.
    points, welded = weld(rig.mesh.vertices, WELD_TOLERANCE * mesh_diagonal(rig))
    tree, within = cKDTree(points), VERTEX_TOLERANCE * mesh_diagonal(rig)
    for axis, position, joint in mirror_planes(rig):
        if (joint >= 0).mean() <= share:
            continue
        near = tree.query(reflected(points, axis, position), distance_upper_bound=within)[1]
        vertex = _vertex_partners(near, welded)
        score = float((vertex[used] >= 0).mean()) * float((joint >= 0).mean())
        if score > share:
            best, share = Mirror(axis, position, vertex, joint), score
    matched = 0.0 if best is None else float((best.vertex[used] >= 0).mean())
    if best is None or matched < MIN_SHARE:
        raise MeshError(
            f"{rig.name} is not mirrored across x, y or z: at best {matched:.0%} of its vertices "
            "have a partner on the other side of a left and a right joint; bind it without "
            "symmetry"
        )
    return best


def mesh_diagonal(rig: Rig) -> float:
    """Return the length of the diagonal of the mesh's bounding box."""
    return float(np.linalg.norm(np.ptp(rig.mesh.bounds, axis=0)))


def mirror_planes(rig: Rig) -> Iterator[tuple[int, float, NDArray[np.intp]]]:
    """Yield axis, position and partners of joints (j,) of planes that mirror some joint."""
    tolerance = JOINT_TOLERANCE * mesh_diagonal(rig)
    for axis in range(3):
        middle = float(rig.mesh.bounds[:, axis].mean())
        median = float(np.median(rig.skeleton.joints[:, axis]))
        for position in dict.fromkeys((0.0, middle, median)):
            joint = _joint_partners(rig.skeleton, axis, position, tolerance)
            if np.any((joint >= 0) & (joint != np.arange(len(joint)))):
                yield axis, position, joint


def mirror_weights(weights: NDArray[np.float64], mirror: Mirror) -> NDArray[np.float64]:
    """Average the weights of each vertex with its partner's, left and right exchanged.

    Shapes: weights (n, j); returns (n, j).
    """
    alone = mirror.joint < 0
    partner = mirror.vertex
    follows_alone: NDArray[np.bool_] = np.asarray((weights[:, alone] > 0).any(axis=1))
    paired = (partner >= 0) & ~follows_alone & ~follows_alone[partner]
    result = weights.copy()
    swap = np.where(alone, np.arange(len(alone)), mirror.joint)
    result[paired] = (weights[paired] + weights[partner[paired]][:, swap]) / 2
    return result


def balance(weights: NDArray[np.float64], mirror: Mirror) -> NDArray[np.float64]:
    """Remove the partner of a joint that pruning removed from a vertex on the plane.

    Shapes: weights (n, j); returns (n, j).
    """
    middle = np.flatnonzero(mirror.vertex == np.arange(len(mirror.vertex)))
    swap = np.where(mirror.joint < 0, np.arange(len(mirror.joint)), mirror.joint)
    rows = weights[middle]
    even = np.where(rows[:, swap] > 0, rows, 0.0)
    total = even.sum(axis=1, keepdims=True)
    before = rows.sum(axis=1, keepdims=True)
    result = weights.copy()
    result[middle] = np.divide(even * before, total, out=rows.copy(), where=total > 0)
    return result


def reflected(points: NDArray[np.float64], axis: int, position: float) -> NDArray[np.float64]:
    result = points.copy()
    result[:, axis] = 2 * position - result[:, axis]
    return result


def _vertex_partners(near: NDArray[np.intp], welded: NDArray[np.int32]) -> NDArray[np.intp]:
    """Pair vertices whose mirror images are nearest to each other.

    Shapes: near (k,), the place nearest to each one's image, k for none; welded (n,).
    """
    every = np.arange(len(near))
    back = np.append(near, len(near))[near]
    first = np.unique(welded, return_index=True)[1]
    partner = np.where(back == every, np.append(first, -1)[near], -1)[welded]
    return np.where((near == every)[welded], np.arange(len(welded)), partner)


def _joint_partners(
    skeleton: Skeleton, axis: int, position: float, tolerance: float
) -> NDArray[np.intp]:
    """Pair joints by position; of several at one position, those whose branches lie alike."""
    joints = skeleton.joints
    branch = skeleton.subtree @ joints / skeleton.subtree.sum(axis=1, keepdims=True)
    gap = cdist(reflected(joints, axis, position), joints)
    branch_gap = cdist(reflected(branch, axis, position), branch)
    depth = skeleton.subtree.sum(axis=0)
    unlike = np.abs(depth[:, None] - depth) / len(joints)
    cost = np.where(gap <= tolerance, (gap + branch_gap) / tolerance + unlike, 1e6)
    cost = (cost + cost.T) / 2  # a pair is one from either side
    partner = linear_sum_assignment(cost)[1]
    near = gap[np.arange(len(joints)), partner] <= tolerance
    partner = np.where(near, partner, -1)
    mutual = (partner >= 0) & (partner[partner] == np.arange(len(joints)))
    partner = np.where(mutual, partner, -1)
    # A chain is no mirror image of itself from end to start: parents must be partners too.
    parents = skeleton.parents
    above = np.where(parents >= 0, partner[parents], -1)
    return np.where((partner >= 0) & (parents[partner] == above), partner, -1)
