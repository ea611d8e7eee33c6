"""Make the weights of a mirrored character mirrored."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from ..errors import MeshError, SkeletonError
from ..geometry.weld import WELD_TOLERANCE, weld
from ..rig import Rig, Skeleton
from ..rig.names import plain

VERTEX_TOLERANCE = 1e-3
"""Maximum distance of a vertex's partner from its mirror image, in bounding-box diagonals."""

JOINT_TOLERANCE = 3e-2
"""The same for joints, which artists place by eye."""

MIN_MIRRORED = 0.5
"""Minimum share of vertices with a partner for a character to count as mirrored."""


@dataclass(frozen=True, eq=False)
class Mirror:
    """A plane of symmetry, and the mirror image of each vertex and joint; -1 for none."""

    axis: int  # 0, 1, 2: the plane is orthogonal to x, y or z
    position: float  # where the plane cuts the axis, in the file's units
    vertex: NDArray[np.intp]  # (n,), itself on the plane
    joint: NDArray[np.intp]  # (j,)
    how: tuple[str, ...] = ()  # (j,), what pairs each joint: "set", "name" or "place"; "" for none

    @property
    def swap(self) -> NDArray[np.intp]:
        """The partner of each joint, shape (j,); itself without one."""
        return np.where(self.joint < 0, np.arange(len(self.joint)), self.joint)


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
            best, share = _mirror(rig, axis, position, vertex, joint), score
    matched = 0.0 if best is None else float((best.vertex[used] >= 0).mean())
    if best is None or matched < MIN_MIRRORED:
        raise MeshError(
            f"{rig.name} is not mirrored across x, y or z: at best {matched:.0%} of its vertices "
            "have a partner on the other side of a left and a right joint; bind it without "
            "symmetry"
        )
    return best


def joint_mirror(rig: Rig) -> Mirror:
    """Find the plane, orthogonal to x, y or z, across which most joints have a partner.

    Unlike for `find_mirror` the mesh need not be mirrored: hair seldom is. No vertex is paired.
    """
    joints = rig.skeleton.joints
    if not len(joints):
        raise SkeletonError(f"{rig.name} has no joints, so none has a partner on the other side")
    best, share, matched = None, 0.0, 0.0
    tolerance = JOINT_TOLERANCE * mesh_diagonal(rig)
    for axis, position, joint in mirror_planes(rig):
        gap = reflected(joints, axis, position)[joint >= 0] - joints[joint[joint >= 0]]
        exact = 1 - float(np.linalg.norm(gap, axis=1).mean()) / tolerance
        score = float((joint >= 0).mean()) + 0.1 * exact
        if score > share:
            share, matched = score, float((joint >= 0).mean())
            best = _mirror(rig, axis, position, np.empty(0, np.intp), joint)
    if best is None or matched < MIN_MIRRORED:
        raise SkeletonError(
            f"the skeleton of {rig.name} is not mirrored across x, y or z: less than half of its "
            "joints have a partner on the other side"
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
            joint = _partners_there(rig.skeleton, axis, position, tolerance)
            if np.any((joint >= 0) & (joint != np.arange(len(joint)))):
                yield axis, position, joint


def mirrored(
    weights: NDArray[np.float64],
    mirror: Mirror,
    points: NDArray[np.float64],
    side: str = "both",
    which: NDArray[np.intp] | None = None,
) -> NDArray[np.float64]:
    """Return weights of some vertices with those of their partners, left and right exchanged.

    With "both" sides, each gets the mean of itself and its partner. "left" or "right" takes the
    side with larger or smaller coordinates in place of the other; the plane gets the mean.
    Vertices that follow a joint without a partner, or whose partner does, stay as they are.

    Shapes: weights (n, j), points (n, 3), which (k,) or None for all; returns (k, j).
    """
    rows = weights.copy() if which is None else weights[which]
    vertex = np.arange(len(weights)) if which is None else which
    partner, alone = mirror.vertex[vertex], mirror.joint < 0
    place = points[vertex, mirror.axis]
    source = {"both": False, "left": place > mirror.position, "right": place < mirror.position}
    takes = np.flatnonzero((partner >= 0) & ((partner == vertex) | ~np.asarray(source[side])))
    other = weights[partner[takes]]
    follows_alone = (rows[takes][:, alone] > 0).any(axis=1) | (other[:, alone] > 0).any(axis=1)
    takes, other = takes[~follows_alone], other[~follows_alone]
    other = other[:, mirror.swap]
    mean = (partner[takes] == vertex[takes]) | (side == "both")
    rows[takes] = np.where(mean[:, None], (rows[takes] + other) / 2, other)
    return rows


def balanced(
    rows: NDArray[np.float64], mirror: Mirror, which: NDArray[np.intp] | None = None
) -> NDArray[np.float64]:
    """Remove the partner of a joint that pruning removed from a vertex on the plane.

    Shapes: rows (k, j) of the vertices (k,), all for None; returns (k, j).
    """
    vertex = np.arange(len(mirror.vertex)) if which is None else which
    middle = np.flatnonzero(mirror.vertex[vertex] == vertex)
    before = rows[middle]
    even = np.where(before[:, mirror.swap] > 0, before, 0.0)
    total = even.sum(axis=1, keepdims=True)
    whole = before.sum(axis=1, keepdims=True)
    result = rows.copy()
    result[middle] = np.divide(even * whole, total, out=before.copy(), where=total > 0)
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


def _partners_there(
    skeleton: Skeleton, axis: int, position: float, tolerance: float
) -> NDArray[np.intp]:
    """Pair joints in mirrored positions: by name, then those whose branches lie alike.

    By position alone no joint that may carry weight is paired with one that may not: controls lie
    where bones do.
    """
    joints, name = skeleton.joints, partners_by_name(skeleton.names)
    branch = skeleton.subtree @ joints / skeleton.subtree.sum(axis=1, keepdims=True)
    gap = cdist(reflected(joints, axis, position), joints)
    every = np.arange(len(joints))
    named = (name >= 0) & (gap[every, name] <= np.minimum(gap[every, every], tolerance))
    branch_gap = cdist(reflected(branch, axis, position), branch)
    depth = skeleton.subtree.sum(axis=0)
    unlike = np.abs(depth[:, None] - depth) / len(joints)
    can = (gap <= tolerance) & (skeleton.deform[:, None] == skeleton.deform)
    cost = np.where(can, (gap + branch_gap) / tolerance + unlike, 1e6)
    cost = (cost + cost.T) / 2  # a pair is one from either side
    cost[named] = 1e6
    cost[named, name[named]] = -1e6
    partner = linear_sum_assignment(cost)[1]
    partner = np.where(cost[every, partner] < 1e6, partner, -1)
    mutual = (partner >= 0) & (partner[partner] == every)
    partner = np.where(mutual, partner, -1)
    # A chain is no mirror image of itself from end to start: parents must be partners too.
    parents = skeleton.parents
    above = np.where(parents >= 0, partner[parents], -1)
    return np.where((partner >= 0) & ((parents[partner] == above) | named), partner, -1)


def _mirror(
    rig: Rig, axis: int, position: float, vertex: NDArray[np.intp], there: NDArray[np.intp]
) -> Mirror:
    """Add pairs that a person set, and pairs of names that are elsewhere, to those (j,) there."""
    names, partner = rig.skeleton.names, there.copy()
    by_name = partners_by_name(names)
    moved = np.flatnonzero((by_name >= 0) & (there < 0) & (there[by_name] < 0))
    partner[moved] = by_name[moved]
    how = np.where(partner < 0, "", np.where(partner == by_name, "name", "place"))
    number = {name: joint for joint, name in enumerate(names)}
    for one, other in rig.partners.items():
        both = [number[name] for name in (one, other) if name in number]
        parted = both + [int(partner[joint]) for joint in both if partner[joint] >= 0]
        partner[parted], how[parted] = -1, ""
        how[both] = "set"
        if len(both) == 2:
            partner[both] = both[::-1]
    return Mirror(axis, position, vertex, partner, tuple(how.tolist()))


def partners_by_name(names: tuple[str, ...]) -> NDArray[np.intp]:
    """Return the joint with the same name for the other side, (j,); -1 for none or several."""
    keys = [plain(name) for name in names]
    of_key: dict[tuple[str, str], list[int]] = {}
    for joint, key in enumerate(keys):
        of_key.setdefault(key, []).append(joint)
    other = {"l": "r", "r": "l"}
    partner = np.full(len(names), -1, np.intp)
    for joint, (base, side) in enumerate(keys):
        opposite = of_key.get((base, other.get(side, "-")), [])
        if len(opposite) == len(of_key[base, side]) == 1:
            partner[joint] = opposite[0]
    return partner
