"""What continues what: the skeleton as its joints lie in the body, not only as the file says.

A file's tree tells what moves with what. Most of its links are bones, but not all: feet for
inverse kinematics hang on a root below the ground, arms and ears branch off sideways, and some
files list their joints without any tree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist

from ..rig import Skeleton
from .probe import BodyProbe
from .rest_axis import rest_directions

SAME_PLACE = 1e-6
"""Of the longest side: joints as near as this are at one place."""
ONWARD = 0.5
"""Cosine: a child within 60 degrees of the way its parent came goes on; others branch off."""
ALONG_AXIS = 0.9
"""Cosine: where the rest axis tells the way of a bone, a child within 25 degrees goes on."""
IN_BODY = 0.5
"""Part of a bone that must run through the body for it to be one."""
BACKWARD = -0.2
"""Cosine: a bone that a link continues may bend by this much, as the hock of a hind leg does."""
REACH = 4.0
"""A link is at most so many times as long as the bone that it continues."""
CLEARLY = 1.2
"""A link is made where the next best is this much farther; of equals neither is right."""
HOP = 1.5
"""Without a tree, a way of hops costs the sum of their lengths to this power: many short hops
along a limb are cheaper than one across, and a straight hop cheaper than a zigzag."""
THROUGH_AIR = 10.0
"""How much dearer a hop is outside the body."""


@dataclass(frozen=True, eq=False)
class Chains:
    """The joints as they follow each other.

    Parameters
    ----------
    joints : array, shape (j, 3)
        In the unit cube.
    near : array, shape (j,), bool
        Joints in the body or right beside it.
    direction : array, shape (j, 3)
        Unit vector of the bone that ends at each joint; zero where none does.
    rest : array, shape (j, 3), or None
        Unit vector along which each joint's own bone points at rest; see `rest_directions`.
    length : array, shape (j,)
        Of that bone; zero where there is none.
    ends : tuple of lists
        The joints that the bones of each joint end at.
    links : tuple of lists
        Further ones, of bones that the tree does not have.
    """

    joints: NDArray[np.float64]
    near: NDArray[np.bool_]
    direction: NDArray[np.float64]
    rest: NDArray[np.float64] | None
    length: NDArray[np.float64]
    ends: tuple[list[int], ...]
    links: tuple[list[int], ...]

    @property
    def onward(self) -> NDArray[np.float64]:
        """Where last joints' bones go, shape (j, 3): along the rest axis, if that is known."""
        return self.direction if self.rest is None else self.rest


def find_chains(skeleton: Skeleton, joints: NDArray[np.float64], probe: BodyProbe) -> Chains:
    """Find out which joints continue which.

    Parameters
    ----------
    skeleton : Skeleton
    joints : array, shape (j, 3)
        Its joints in the unit cube.
    probe : BodyProbe
    """
    near = probe.near(joints)
    same = cdist(joints, joints) < SAME_PLACE
    if not _has_bones(skeleton):
        parents = _grown_tree(skeleton, joints, near, probe)
        skeleton = replace(skeleton, parents=parents)
    direction, length = _directions(skeleton, joints, near, same, probe)
    rest = rest_directions(skeleton, joints)
    ends = _ends(skeleton, joints, near, same, direction, rest)
    links = _links(skeleton, joints, direction, length, ends, probe)
    return Chains(joints, near, direction, rest, length, ends, links)


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
    """Return direction and length of the bone that ends at each joint, zero where none does.

    The link to a parent is a bone if it begins in the body and runs through it: a root on the
    ground is no place to come from. `same`, shape (j, j), tells which joints are at one place.
    """
    parent = skeleton.parents.copy()
    for j in np.flatnonzero((parent >= 0) & same[parent, np.arange(len(parent))]):
        while parent[j] >= 0 and same[parent[j], j]:
            parent[j] = skeleton.parents[parent[j]]
    away = joints - joints[parent]
    length = np.linalg.norm(away, axis=1)
    bone = (parent >= 0) & near[parent] & (length >= SAME_PLACE)
    bone[bone] = probe.inner_part(joints[parent[bone]], joints[bone]) >= IN_BODY
    length = np.where(bone, length, 0.0)
    direction = np.divide(away, length[:, None], out=np.zeros_like(away), where=bone[:, None])
    return direction, length


def _ends(
    skeleton: Skeleton,
    joints: NDArray[np.float64],
    near: NDArray[np.bool_],
    same: NDArray[np.bool_],
    direction: NDArray[np.float64],
    rest: NDArray[np.float64] | None,
) -> tuple[list[int], ...]:
    """List where the bones of each joint end.

    They run to its children, but where the body forks and no child goes on: then, as with a
    head and its ears, the children are side branches and the joint's own bone is not in the
    file. A child goes on if it lies along the joint's rest axis, or, where that is not known or
    points elsewhere than the bone before it, the way that bone came. A joint outside the body
    has no bone at all.
    """
    ends: tuple[list[int], ...] = tuple([] for _ in joints)
    child, parent = np.arange(len(joints)), skeleton.parents
    leads = (parent >= 0) & (skeleton.deform | near) & ~same[parent, child]
    leads &= (skeleton.deform & near)[parent]
    for k in np.flatnonzero(leads).tolist():
        ends[parent[k]].append(k)
    for j, children in enumerate(ends):
        if len(children) > 1 and direction[j].any():
            away = joints[children] - joints[j]
            away /= np.linalg.norm(away, axis=1, keepdims=True)
            way, least = direction[j], ONWARD
            if rest is not None and rest[j] @ way >= ONWARD:
                way, least = rest[j], ALONG_AXIS
            if (away @ way).max() < least:
                children.clear()
    return ends


def _links(
    skeleton: Skeleton,
    joints: NDArray[np.float64],
    direction: NDArray[np.float64],
    length: NDArray[np.float64],
    ends: tuple[list[int], ...],
    probe: BodyProbe,
) -> tuple[list[int], ...]:
    """Join chains that end with joints that no bone leads to, as a shin with the foot below it.

    Both must be each other's clear choice: nearest, through the body, and not backward.
    """
    links: tuple[list[int], ...] = tuple([] for _ in joints)
    loose = np.flatnonzero(skeleton.deform & (length == 0))
    has_end = np.array([len(those) > 0 for those in ends])
    tips = np.flatnonzero(skeleton.deform & ~has_end & (length > 0))
    away = joints[loose] - joints[tips, None]
    far = np.linalg.norm(away, axis=2)
    onward = np.einsum("tlc,tc->tl", away, direction[tips])
    fits = (far >= SAME_PLACE) & ~skeleton.subtree[loose][:, tips].T
    fits &= (far <= REACH * length[tips, None]) & (onward >= BACKWARD * far)
    tip, goal = fits.nonzero()
    fits[tip, goal] = probe.inner_part(joints[tips[tip]], joints[loose[goal]]) >= IN_BODY
    distance = np.where(fits, far, np.inf)
    choice = _clear_choice(distance, joints[loose])
    suits = np.arange(len(loose)) == choice[:, None]
    suitor = _clear_choice(np.where(suits, distance, np.inf).T, joints[tips])
    for k in np.flatnonzero(suitor >= 0):
        links[tips[suitor[k]]].append(int(loose[k]))
    return links


def _clear_choice(far: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.intp]:
    """Find who is nearest to each, shape (n,); -1 where another, elsewhere, is about as near.

    Parameters
    ----------
    far : array, shape (n, m)
        Infinite for those that are no choice.
    places : array, shape (m, 3)
    """
    if far.size == 0:
        return np.full(len(far), -1)
    first = far.argmin(axis=1)
    least = far.min(axis=1)
    elsewhere = (cdist(places, places) >= SAME_PLACE)[first]
    next_best = np.where(elsewhere, far, np.inf).min(axis=1)
    return np.where((least < np.inf) & (next_best > CLEARLY * least), first, -1)


def _grown_tree(
    skeleton: Skeleton, joints: NDArray[np.float64], near: NDArray[np.bool_], probe: BodyProbe
) -> NDArray[np.int32]:
    """Make up a tree for joints without one; return the parents.

    From the root each joint is reached by its cheapest way of hops. The root is the joint from
    which these ways are straightest.
    """
    parents = np.full(len(joints), -1, np.int32)
    members = np.flatnonzero(skeleton.deform | near)
    if len(members) < 3:
        return parents
    # In an order of their own, so that ties do not hang on how a file numbers joints.
    members = members[np.lexsort(joints[members].T[::-1])]
    places = joints[members]
    away = places[None] - places[:, None]
    length = np.linalg.norm(away, axis=2)
    air = 1 - probe.inner_part(places[:, None], places[None], strictly=True)
    # Joints at one place cost next to nothing, but not nothing: that would be no link.
    cost = np.maximum(length**HOP * (1 + THROUGH_AIR * air), 1e-12)
    before = dijkstra(cost, return_predecessors=True)[1]
    unit = np.divide(away, length[..., None], out=np.zeros_like(away), where=length[..., None] > 0)
    best, least = -1, np.inf
    for root in np.flatnonzero(skeleton.deform[members]):
        # Hops from the root itself bend nothing.
        to = np.flatnonzero((before[root] >= 0) & (before[root] != root))
        via = before[root][to]
        bend = (1 - (unit[before[root][via], via] * unit[via, to]).sum(axis=1)).sum()
        if bend < least * (1 - SAME_PLACE):
            best, least = int(root), float(bend)
    reached = before[best] >= 0
    parents[members[reached]] = members[before[best][reached]]
    return parents
