"""Which joints may carry weight: by their names, their place in the body, or a choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from fnmatch import fnmatchcase

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import ParameterError
from ..mesh import TriangleMesh
from ..names import (
    folded,
    is_control,
    is_end_marker,
    is_fingertip,
    is_mmd_control,
    is_mmd_tip,
    is_of_mmd,
    is_root,
    is_socket,
    may_be_control,
    words,
)
from ..rig import FAR_OUTSIDE, Rig
from ..skeleton import Skeleton
from .body import SPACING, Body

OUTSIDE = 0.04
"""Distance from the body beyond which a joint moves none of it, in longest sides."""
FEW_BONES = 0.15
"""Distance from the body at which a root may lie whose children are all other joints."""
SAME_PLACE = 0.01
"""Largest distance of a control from the joint that it controls, relative to the longest side."""
THROUGH_BODY = 0.5
"""Part of a link between two joints that must run in or near the body for it to be a bone."""
ALONG = np.linspace(0.1, 0.9, 9)
"""Samples along a link."""
NOTHING_BEYOND = 0.15
"""Lengths of the bone before: a last joint with less skin beyond it marks the end of that bone."""
ENOUGH_NEAR = 0.5
"""Part of the joints that must be near the mesh for it to be a body, not a garment."""

MAX_JOINTS = 2_000
"""Joints beyond which only names count, since places would take minutes."""

BONE = "in or near the body"


@dataclass(frozen=True, eq=False)
class DeformJoints:
    """Which joints may carry weight, and why.

    Parameters
    ----------
    deform : array, shape (j,), bool
    reason : tuple of str
        For each joint, a phrase.
    """

    deform: NDArray[np.bool_]
    reason: tuple[str, ...]


def deform_joints(mesh: TriangleMesh, skeleton: Skeleton, body: Body | None = None) -> DeformJoints:
    """Classify joints as bones, controls, end markers, sockets or roots, without weights.

    Names decide where riggers and exporters have words for it; else where a joint lies: what is
    outside of the body moves nothing, and neither does a joint with no skin beyond it at the end
    of a bone. In garments and props, where most joints are away from the mesh, only names count.

    Parameters
    ----------
    mesh : TriangleMesh
    skeleton : Skeleton
        Its own `deform` is not looked at.
    body : Body, optional
        Of the mesh, if it has been sampled already.

    Returns
    -------
    DeformJoints
        At least one joint may carry weight.

    Raises
    ------
    SkeletonError
        The skeleton has no joints.
    """
    skeleton.require_joints()
    guess = _Guess(mesh, skeleton, body or Body(mesh))
    guess.by_name()
    if guess.is_body:
        guess.by_place()
    if not guess.deform.any():  # a rig of nothing but controls: then they are what moves it
        return DeformJoints(np.ones(len(skeleton.joints), bool), (BONE,) * len(skeleton.joints))
    return DeformJoints(guess.deform, tuple(guess.reason))


class _Guess:
    def __init__(self, mesh: TriangleMesh, skeleton: Skeleton, body: Body) -> None:
        self.names, self.parents = skeleton.names, skeleton.parents
        self.children = skeleton.children
        self.leaves_first = np.argsort(-skeleton.depth, kind="stable").tolist()
        self.body = body
        self.joints = self.body.to_unit(skeleton.joints)
        self.vertices = self.body.to_unit(mesh.vertices[np.unique(mesh.faces)])
        self.distance = np.zeros(len(self.joints))
        self.is_body = False
        if len(self.joints) <= MAX_JOINTS:
            self.distance = self.body.away(self.joints)
            self.is_body = bool((self.distance <= OUTSIDE).mean() >= ENOUGH_NEAR)
        self.deform = np.ones(len(self.joints), bool)
        self.reason = [BONE] * len(self.joints)

    def by_name(self) -> None:
        """Rule out what is called an end marker, a socket, or a control of another joint."""
        marked = [words(name)[:1] == ["def"] for name in self.names]  # Rigify's `DEF-spine`
        of_mmd = any(map(is_of_mmd, self.names))
        for j in self.leaves_first:
            if any(marked) and not marked[j]:
                self._rule_out(j, "others are marked DEF")
                continue
            name = self.names[j]
            is_marker = is_end_marker(name) or is_fingertip(name) or (of_mmd and is_mmd_tip(name))
            if is_marker and not len(self._bones_below(j)):
                self._rule_out(j, "end marker, by its name")
            elif is_socket(name):
                self._rule_out(j, "holds things, by its name")
            elif is_control(name) or (of_mmd and is_mmd_control(name)):
                self._rule_out(j, "control, by its name")
        self._by_name_and_place(np.array([may_be_control(name) for name in self.names]))

    def _by_name_and_place(self, unsure: NDArray[np.bool_]) -> None:
        """Rule out what may be a control and stands where another joint does, or in the air."""
        others = np.flatnonzero(self.deform & ~unsure)
        tree = cKDTree(self.joints[others]) if len(others) else None
        for j in reversed(self.leaves_first):
            if not (self.deform[j] and unsure[j]):
                continue
            away, k = tree.query(self.joints[j]) if tree else (np.inf, 0)
            parent = self.parents[j]
            if away <= SAME_PLACE:
                at = self.names[others[k]]
                self._rule_out(j, f'control at the place of "{at}"')
            elif self.distance[j] > SPACING:
                self._rule_out(j, "control outside of the body")
            elif parent >= 0 and "control" in self.reason[parent]:
                self._rule_out(j, "part of a control")

    def by_place(self) -> None:
        """Rule out what is away from the body, but in its units, root joints and ends of bones."""
        for j in self.leaves_first:
            if not self.deform[j]:
                continue
            below = self._bones_below(j)
            if not len(below) and self._ends_a_bone(j):
                self._rule_out(j, "end marker: no skin beyond it")
            elif OUTSIDE < self.distance[j] < FAR_OUTSIDE and not self._leads_into_body(j, below):
                self._rule_out(j, "outside of the body")
            elif self.parents[j] < 0 and self._stands_beside(j, below):
                self._rule_out(j, "root beside the body")

    def _rule_out(self, joint: int, reason: str) -> None:
        self.deform[joint], self.reason[joint] = False, reason

    def _bones_below(self, joint: int) -> NDArray[np.intp]:
        children = self.children[joint]
        return children[self.deform[children]]

    def _stands_beside(self, joint: int, below: NDArray[np.intp]) -> bool:
        """Return whether a root lies outside, and moves others rather than skin."""
        chained = any(len(self._bones_below(k)) for k in below)
        is_all = self.deform.sum() == 1 + len(below)
        if is_all and not chained and self.distance[joint] <= FEW_BONES:
            return False  # it moves what the few parts that hang on it do not
        if 0 < self.distance[joint] <= SPACING and self.body.encloses(self.joints[joint]):
            return False
        outside = self.distance[joint] > 0 and len(below) > 0
        return outside and (is_root(self.names[joint]) or not self._leads_into_body(joint, below))

    def _leads_into_body(self, joint: int, others: NDArray[np.intp]) -> bool:
        """Return whether a link to any of the others runs through the body."""
        away = self.joints[others] - self.joints[joint]
        points = (self.joints[joint] + ALONG[:, None] * away[:, None]).reshape(-1, 3)
        near = self.body.to_surface(points) <= OUTSIDE
        near[~near] = self.body.inside(points[~near])
        return bool((near.reshape(-1, len(ALONG)).mean(axis=1) >= THROUGH_BODY).any())

    def _ends_a_bone(self, joint: int) -> bool:
        """Return whether a last joint lies at the end of a chain of bones, with no skin beyond."""
        parents, joints = self.parents, self.joints
        parent = parents[joint]
        if parent < 0 or parents[parent] < 0 or len(self.children[parent]) > 1:
            return False
        bone = joints[joint] - joints[parent]
        length = np.linalg.norm(bone)
        if length == 0 or length > 3 * np.linalg.norm(joints[parent] - joints[parents[parent]]):
            return False
        away = self.vertices - joints[joint]
        apart, beyond = np.linalg.norm(away, axis=1), (away @ bone) / length
        around = (apart < length) & (beyond > -0.05 * length)
        no_skin = beyond.max(initial=-1, where=around) < NOTHING_BEYOND * length
        return bool(around.any() and no_skin and apart[around].max() < length / 2)


def choose_deform(
    rig: Rig, deform: Sequence[str] = (), no_deform: Sequence[str] = (), *, fresh: bool = False
) -> Rig:
    """Return the same rig with other joints that may carry weight.

    Parameters
    ----------
    rig : Rig
    deform, no_deform : sequences of str
        Names of joints that shall, or shall not, carry weight. ``*`` and ``?`` stand for any
        letters and for one; upper and lower case are the same, and so are full and half width.
        A joint that both name carries none.
    fresh : bool
        Forget the file's weights first, and which joints they are of: `deform_joints` says.

    Returns
    -------
    Rig

    Raises
    ------
    ParameterError
        A name that no joint has, or no joint left that may carry weight.

    Examples
    --------
    >>> rig = cutcell.choose_deform(rig, no_deform=["*_IK", "Root"])  # doctest: +SKIP
    """
    skeleton = rig.skeleton
    chosen = skeleton.deform.copy()
    if fresh and len(chosen):
        rig = rig.with_weights(None)
        chosen = deform_joints(rig.mesh, skeleton).deform.copy()
    for patterns, value in ((deform, True), (no_deform, False)):
        for pattern in patterns:
            chosen[_named(skeleton, pattern)] = value
    if len(chosen) and not chosen.any():
        raise ParameterError("no joint is left that may carry weight; choose fewer to leave out")
    return replace(rig, skeleton=replace(skeleton, deform=chosen))


def _named(skeleton: Skeleton, pattern: str) -> list[int]:
    wanted, names = folded(pattern), [folded(name) for name in skeleton.names]
    found = [j for j, name in enumerate(names) if name == wanted]
    # A name may hold what stands for other letters; then it means itself.
    found = found or [j for j, name in enumerate(names) if fnmatchcase(name, wanted)]
    if not found:
        near = get_close_matches(wanted, names, 3, 0.4)
        close = [skeleton.names[names.index(name)] for name in near]
        hint = f"; did you mean {' or '.join(close)}?" if close else ""
        raise ParameterError(f'no joint is called "{pattern}"{hint}')
    return found
