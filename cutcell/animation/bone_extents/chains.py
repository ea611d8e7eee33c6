"""Bone chains: which bones continue which, from the places of joints in the body.

The joint tree of a file defines which joints move together. Most of its parent-child pairs are
bones, but not all: feet for inverse kinematics are children of a root below the ground, arms and
ears branch off sideways, and some files list their joints without any tree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist

from ...rig import Skeleton
from .face import face_parts
from .probe import BodyProbe
from .rest_axis import rest_directions
from .twists import with_twists_in_chain

MIN_BODY_JOINTS = 0.7
"""A mesh with a smaller part of its deforming joints in it is a garment without its body."""
COINCIDENT_ENDS = 1e-6
"""Largest distance of coincident joints, relative to the longest side."""
ONWARD = 0.5
"""Cosine: a child within 60 degrees of the rest axis continues the bone; others branch off."""
ON_AXIS = 0.98
"""Cosine: the direction of a child that lies on the rest axis itself."""
SIDE_BRANCH = 2.0
"""Where a child lies on the rest axis, no bone to another is more than this many times as long."""
PASSES = 0.1
"""A bone to a child that passes another child nearer than this part of its length is none."""
MIN_BONE_IN_BODY = 0.5
"""Part of a bone that must run through the body for it to be one."""
MAX_LENGTH_RATIO = 3.0
"""Length of a bone whose end is a guess over that of its parent's bone, at most: a head that looks
back along its body is not as long as the body, and an end marker may be anywhere."""
LENGTH = 1.1
"""The length of an inferred bone over that of the bone that it continues, at most: the halves of a
limb are about equally long."""
UNAMBIGUOUS_RATIO = 1.2
"""A bone is inferred if the second-best candidate is farther by this factor; else it is
ambiguous."""
HOP = 1.5
"""Without a tree, edges between joints cost their length to this power: many short ones along a
limb are cheaper than one across, and a straight one is cheaper than a zigzag."""
THROUGH_AIR = 10.0
"""Extra cost of an edge outside the body."""


@dataclass(frozen=True, eq=False)
class Chains:
    """The bones between joints.

    Parameters
    ----------
    joints : array, shape (j, 3)
        In the unit cube.
    near : array, shape (j,), bool
        Joints in the body or right beside it; all joints of a garment alone.
    direction : array, shape (j, 3)
        Unit vector of the bone that ends at each joint; zero if there is none.
    rest : array, shape (j, 3), or None
        Unit vector of each joint's own bone at rest; see `rest_directions`.
    length : array, shape (j,)
        Length of the bone that ends at each joint; zero if there is none.
    ends : tuple of lists
        The joints at which the bones of each joint end.
    inferred : tuple of lists
        The joints at which inferred bones end, which the tree does not have.
    in_face, in_eye : arrays, shape (j,), bool
        Eyes, brows, jaws...; see `face_parts`.
    """

    joints: NDArray[np.float64]
    near: NDArray[np.bool_]
    direction: NDArray[np.float64]
    rest: NDArray[np.float64] | None
    length: NDArray[np.float64]
    ends: tuple[list[int], ...]
    inferred: tuple[list[int], ...]
    in_face: NDArray[np.bool_]
    in_eye: NDArray[np.bool_]

    @property
    def onward(self) -> NDArray[np.float64]:
        """Directions of leaf bones, shape (j, 3): along the rest axis, if that is known."""
        return self.direction if self.rest is None else self.rest


def find_chains(
    skeleton: Skeleton,
    joints: NDArray[np.float64],
    together: NDArray[np.bool_],
    probe: BodyProbe,
) -> Chains:
    """Find the bone chains of a skeleton.

    Shapes: joints (j, 3), together (j, j): which joints one skin holds.
    """
    skeleton, joints = with_twists_in_chain(skeleton, joints)
    near = probe.near(joints)
    if near[skeleton.deform].mean() < MIN_BODY_JOINTS:
        near[:] = True  # the joints are where the body would be
    same = cdist(joints, joints) < COINCIDENT_ENDS
    if not _has_bones(skeleton):
        parents = _inferred_tree(skeleton, joints, near, probe)
        skeleton = replace(skeleton, parents=parents)
    direction, length = _directions(skeleton, joints, near, same, probe)
    rest = rest_directions(skeleton, joints)
    in_face, in_eye = face_parts(skeleton)
    ends = _ends(skeleton, joints, near, same, length, rest, in_face)
    inferred = _inferred_bones(
        skeleton, joints, near, direction, length, ends, same, together, probe
    )
    return Chains(joints, near, direction, rest, length, ends, inferred, in_face, in_eye)


def _has_bones(skeleton: Skeleton) -> bool:
    above = skeleton.parents[skeleton.parents >= 0]
    return bool(skeleton.deform[above].any())


def _directions(
    skeleton: Skeleton,
    joints: NDArray[np.float64],
    near: NDArray[np.bool_],
    same: NDArray[np.bool_],
    probe: BodyProbe,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return direction and length of the bone that ends at each joint, zero if there is none.

    A parent and its child are the ends of a bone if it begins in the body and runs through it,
    unlike from a root on the ground. `same`, shape (j, j), marks joints that coincide.
    """
    parent = skeleton.parents.copy()
    for j in np.flatnonzero((parent >= 0) & same[parent, np.arange(len(parent))]):
        while parent[j] >= 0 and same[parent[j], j]:
            parent[j] = skeleton.parents[parent[j]]
    away = joints - joints[parent]
    length = np.linalg.norm(away, axis=1)
    bone = (parent >= 0) & near[parent] & (length >= COINCIDENT_ENDS)
    bone[bone] = probe.inner_part(joints[parent[bone]], joints[bone]) >= MIN_BONE_IN_BODY
    length = np.where(bone, length, 0.0)
    return np.where(bone[:, None], _unit(away), 0.0), length


def _ends(
    skeleton: Skeleton,
    joints: NDArray[np.float64],
    near: NDArray[np.bool_],
    same: NDArray[np.bool_],
    length: NDArray[np.float64],
    rest: NDArray[np.float64] | None,
    in_face: NDArray[np.bool_],
) -> tuple[list[int], ...]:
    """List where the bones of each joint end; a leaf bone ends at the joint itself.

    Bones run to the joint's children, see `_branches`. A head whose children are all in the face
    has a leaf bone besides. A joint outside the body has no bone, and an end marker far off is no
    end.
    """
    ends: tuple[list[int], ...] = tuple([] for _ in joints)
    child, parent = np.arange(len(joints)), skeleton.parents
    leads = (parent >= 0) & (skeleton.deform | near) & ~same[parent, child]
    leads &= (skeleton.deform & near)[parent]
    is_marker = ~skeleton.deform & ~np.isin(child, parent) & (length[parent] > 0)
    leads &= ~is_marker | (
        np.linalg.norm(joints - joints[parent], axis=1) <= MAX_LENGTH_RATIO * length[parent]
    )
    for k in np.flatnonzero(leads).tolist():
        ends[parent[k]].append(k)
    for j, children in enumerate(ends):
        if len(children) > 1:
            axis = None if rest is None else rest[j]
            children[:] = _branches(j, children, joints, axis)
        if children and not in_face[j] and in_face[children].all():
            children.append(j)
    return ends


def _branches(
    joint: int, children: list[int], joints: NDArray[np.float64], axis: NDArray[np.float64] | None
) -> list[int]:
    """List to which of several children a joint's bones run.

    Where the rest axis is known and no child lies along it, as between the ears of a head, the
    joint has a leaf bone besides: the list then ends with the joint itself.
    """
    away = joints[children] - joints[joint]
    length = np.linalg.norm(away, axis=1)
    along = away @ away.T / length[:, None] ** 2
    offset = np.linalg.norm(away - along[:, :, None] * away[:, None], axis=2)
    between = (along > PASSES) & (along < 1 - PASSES)
    is_bone = ~(between & (offset < PASSES * length[:, None])).any(axis=1)
    leaf = []
    if axis is not None:
        cosine = away @ axis / length
        if cosine.max() < ONWARD:
            leaf = [joint]
        else:
            on_axis = cosine > ON_AXIS
            if on_axis.any():
                is_bone &= length <= SIDE_BRANCH * length[on_axis].max()
    return np.array(children)[is_bone].tolist() + leaf


def _inferred_bones(
    skeleton: Skeleton,
    joints: NDArray[np.float64],
    near: NDArray[np.bool_],
    direction: NDArray[np.float64],
    length: NDArray[np.float64],
    ends: tuple[list[int], ...],
    same: NDArray[np.bool_],
    together: NDArray[np.bool_],
    probe: BodyProbe,
) -> tuple[list[int], ...]:
    """Infer bones from ends of chains to joints whose parent is a control, as from shin to foot.

    Each must be the other's clear choice: the nearest through the body, onward and not far. No
    other bone ends at either. `together`, shape (j, j), marks joints that one skin holds.
    """
    inferred: tuple[list[int], ...] = tuple([] for _ in joints)
    deform, parents = skeleton.deform, skeleton.parents
    is_end = (length > 0) & deform
    is_end[[k for j, those in enumerate(ends) for k in those if k != j]] = True
    arriving = (same & together) @ is_end.astype(int)
    has_bone = (same & together) @ np.array([len(those) > 0 for those in ends])
    on_control = (parents < 0) | ~(deform & near)[parents]
    goals = np.flatnonzero(deform & on_control & (arriving == 0))
    leaves = np.flatnonzero(deform & (length > 0) & (arriving == 1) & ~has_bone)
    away = joints[goals] - joints[leaves, None]
    far = np.linalg.norm(away, axis=2)
    fits = together[np.ix_(leaves, goals)] & ~skeleton.subtree[np.ix_(goals, leaves)].T
    fits &= (far >= COINCIDENT_ENDS) & (far <= LENGTH * length[leaves, None])
    fits &= np.einsum("tgc,tc->tg", away, direction[leaves]) >= 0
    leaf, goal = fits.nonzero()
    fits[leaf, goal] = probe.inner_part(joints[leaves[leaf]], joints[goals[goal]]) == 1
    distance = np.where(fits, far, np.inf)
    choice = _clear_choice(distance)
    suits = np.arange(len(goals)) == choice[:, None]
    suitor = _clear_choice(np.where(suits, distance, np.inf).T)
    for k in np.flatnonzero(suitor >= 0):
        inferred[leaves[suitor[k]]].append(int(goals[k]))
    return inferred


def _clear_choice(far: NDArray[np.float64]) -> NDArray[np.intp]:
    """Find the nearest of each of n rows of candidates; -1 if another one is about as near."""
    if far.size == 0:
        return np.full(len(far), -1)
    least = far.min(axis=1)
    is_clear = (least < np.inf) & ((far <= UNAMBIGUOUS_RATIO * least[:, None]).sum(axis=1) == 1)
    return np.where(is_clear, far.argmin(axis=1), -1)


def _inferred_tree(
    skeleton: Skeleton, joints: NDArray[np.float64], near: NDArray[np.bool_], probe: BodyProbe
) -> NDArray[np.int32]:
    """Infer a tree for joints without one; return the parents.

    It is the tree of cheapest paths from the root. The root is the joint whose paths are
    straightest.
    """
    parents = np.full(len(joints), -1, np.int32)
    members = np.flatnonzero(skeleton.deform | near)
    if len(members) < 3:
        return parents
    # Sorted by position, so that ties do not depend on how a file numbers joints.
    members = members[probe.lattice.order(joints[members])]
    places = joints[members]
    length = cdist(places, places)
    # One by one: all at once, the sample points of many segments would fill the memory.
    inner = [probe.inner_part(place, places, strictly=True) for place in places]
    air = 1 - np.array(inner)
    # Whole numbers, whose sums are exact. Coincident joints cost 1, as zero would mean no edge.
    cost = np.maximum(np.rint(length**HOP * (1 + THROUGH_AIR * air) * 1e12), 1)
    before = dijkstra(cost, return_predecessors=True)[1]
    best, least = -1, np.inf
    for root in np.flatnonzero(skeleton.deform[members]):
        # Edges from the root itself do not bend.
        to = np.flatnonzero((before[root] >= 0) & (before[root] != root))
        via = before[root][to]
        arriving, leading = places[via] - places[before[root][via]], places[to] - places[via]
        cosine = (_unit(arriving) * _unit(leading)).sum(axis=1)
        bend = (1 - cosine).sum()
        if bend < least * (1 - COINCIDENT_ENDS):
            best, least = int(root), float(bend)
    reached = before[best] >= 0
    parents[members[reached]] = members[before[best][reached]]
    return parents


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors (n, 3) of length one, zero for those of no length."""
    length = np.linalg.norm(vectors, axis=1)[:, None]
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
