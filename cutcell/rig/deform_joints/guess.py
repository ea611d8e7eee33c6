"""Which joints may carry weight, by their names and their place in the body."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.segments import distance_to_segment
from ..mesh import TriangleMesh
from ..rig import FAR_OUTSIDE
from ..skeleton import Skeleton
from .body import SURFACE_SPACING, Body
from .conventions import kinds_by_name
from .joints import BONE, OFF_BODY_DISTANCE, SAME_POSITION, Joints

FEW_BONES = 0.15
"""Distance from the body at which a root may lie whose children are all other joints."""
CONTROL_DISTANCE = 0.01
"""Largest distance of a control from the joint that it controls, relative to the longest side."""
ENOUGH_NEAR = 0.5
"""Part of the joints that must be near the mesh for it to be a body, not a garment."""
IK = re.compile(r"\bikp?\b")
"""In names of controls of inverse kinematics."""
LACKING_RATIO = 0.5
"""Distance of skin from a joint, relative to its nearest bone, at which it lacks the joint."""
LACKING = 0.03
"""Part of the skin that must lack a joint for the joint to deform."""
MAX_LACKING_DISTANCE = 0.1
"""Distance from the body beyond which no skin lacks a joint, in longest sides."""

MAX_PLACED_JOINTS = 2_000
"""Joints beyond which only names count, since places would take minutes."""

OFF_BODY = "outside of the body"


@dataclass(frozen=True, eq=False)
class DeformJoints:
    """Which joints may carry weight, and why.

    Parameters
    ----------
    deform : array, shape (j,), bool
    reason : tuple of str
        For each joint, a phrase.
    doubtful : array, shape (j,), bool
        Joints that may carry weight, but could as well be controls or mark an end.
    """

    deform: NDArray[np.bool_]
    reason: tuple[str, ...]
    doubtful: NDArray[np.bool_]


def deform_joints(mesh: TriangleMesh, skeleton: Skeleton, body: Body | None = None) -> DeformJoints:
    """Classify joints as bones, controls, end markers, sockets or roots, without weights.

    Names decide where riggers and exporters have words for it; else where a joint lies: what is
    outside of the body moves nothing, and neither does a joint at the place of another that moves
    it. In garments and props, where most joints are away from the mesh, only names count. Where
    neither decides, a joint may carry weight and is doubtful.

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
    guess = _Guess(skeleton, body or Body(mesh))
    guess.by_name()
    if len(skeleton.joints) <= MAX_PLACED_JOINTS and guess.is_in_body():
        guess.by_place()
        guess.by_skin()
    if not guess.deform.any():  # a rig of nothing but controls: then they are what moves it
        every = np.ones(len(skeleton.joints), bool)
        return DeformJoints(every, (BONE,) * len(every), every)
    return DeformJoints(guess.deform, tuple(guess.reason), guess.doubtful & guess.deform)


class _Guess(Joints):
    def __init__(self, skeleton: Skeleton, body: Body) -> None:
        super().__init__(skeleton, body)
        self.kinds = kinds_by_name(self.names)
        if len(self.joints) <= MAX_PLACED_JOINTS:
            self.distance = body.away(self.joints)

    def is_in_body(self) -> bool:
        """Return whether the mesh is a body, not a garment: most bones are near it."""
        near = self.distance[self.deform] <= OFF_BODY_DISTANCE
        return bool(near.sum() > ENOUGH_NEAR * len(near))

    def by_name(self) -> None:
        """Rule out what is called an end marker, a socket, or a control of another joint."""
        for j in self.leaves_first:
            kind, reason = self.kinds[j]
            is_end = kind == "ends" and not len(self.bones_below(j))
            if is_end or kind in ("controls", "sockets", "roots"):
                self.rule_out(j, reason)
        for j in reversed(self.leaves_first):  # joints below marked bones deform, too
            kind, reason = self.kinds[j]
            parent = self.parents[j]
            if kind == "others" and (parent < 0 or not self.deform[parent]):
                self.rule_out(j, reason)
        self._by_name_and_place(np.array([kind == "unsure" for kind, _ in self.kinds]))

    def _by_name_and_place(self, unsure: NDArray[np.bool_]) -> None:
        """Rule out what may be a control and stands where another joint does, or in the air."""
        sure = np.flatnonzero(self.deform & ~unsure)
        for j in reversed(self.leaves_first):
            if not (self.deform[j] and unsure[j]):
                continue
            self.doubt(j, "control or bone, by its name")
            parent = self.parents[j]
            away = np.linalg.norm(self.joints[sure] - self.joints[j], axis=1)
            away[np.isin(sure, self.chain(j))] = np.inf
            k = sure[away.argmin()] if len(sure) else j
            if away.min(initial=np.inf) <= CONTROL_DISTANCE:
                self.rule_out(j, f'control at the place of "{self.names[k]}"')
            elif self.distance[j] > SURFACE_SPACING:
                self.rule_out(j, "control outside of the body")
            elif parent >= 0 and "control" in self.reason[parent]:
                self.rule_out(j, "part of a control")
            elif k != j and self.plain[j][1] == self.plain[k][1] and self.ends_limb(k):
                self.rule_out(j, f'control of "{self.names[k]}"')
        for j in self.leaves_first:
            is_ik = self.deform[j] and unsure[j] and IK.search(self.plain[j][0])
            if is_ik and not len(self.bones_below(j)):
                self.rule_out(j, "control without bones below it, by its name")

    def by_place(self) -> None:
        """Rule out what was never placed, is away from the body, or where another joint is."""
        absent = np.zeros(len(self.deform), bool)
        for j in self.leaves_first:
            if not self.deform[j]:
                continue
            below = self.bones_below(j)
            if OFF_BODY_DISTANCE < self.distance[j] < FAR_OUTSIDE and not len(below):
                self.rule_out(j, OFF_BODY)
            elif self.distance[j] <= OFF_BODY_DISTANCE and not len(below) and self.ends_a_bone(j):
                self.rule_out(j, "end marker: no skin beyond it")
            elif len(self.children[j]):
                absent[j] = all(absent[k] or self.reason[k] == OFF_BODY for k in self.children[j])
        for j in np.flatnonzero(absent).tolist():
            self.doubt(j, "in a limb outside of the body")
        for j in reversed(self.leaves_first):
            if self.deform[j]:
                below = self.bones_below(j)
                (self._top if len(below) and self.is_top(j) else self._inner)(j, below)
        self._doubled()

    def _top(self, joint: int, below: NDArray[np.intp]) -> None:
        """Rule out a joint without bones above it that moves others rather than skin."""
        chained = any(len(self.bones_below(k)) for k in below)
        is_all = self.deform.sum() == 1 + len(below)
        if is_all and not chained and self.distance[joint] <= FEW_BONES:
            return  # it moves the skin that its few children do not
        is_named = self.kinds[joint][0] == "root"
        if len(below) <= 2 and all(self.together(joint, k) for k in below):
            # Another bone is harmless there, while the wrong one of two turns too much.
            decide = self.rule_out if is_named else self.doubt
            decide(joint, f'root at the place of "{self.names[below[0]]}"')
        elif self.is_outside(joint):
            leads = self.leads_into_body(joint, below) and not self.is_longest(joint, below)
            if is_named or not leads:
                decide = self.rule_out if is_named or len(below) < 3 else self.doubt
                decide(joint, "root beside the body")
        elif is_named:
            moves_controls = any(self.kinds[k][0] == "controls" for k in self.children[joint])
            decide = self.rule_out if moves_controls else self.doubt
            decide(joint, "root, by its name")

    def _inner(self, joint: int, below: NDArray[np.intp]) -> None:
        """Rule out a joint that was never placed; note one at its child, or outside of the body."""
        if self.distance[joint] > OFF_BODY_DISTANCE:
            self.doubt(joint, OFF_BODY)
        elif len(below) == 1 and self.together(joint, below[0]):
            self.doubt(joint, f'at the place of "{self.names[below[0]]}"')
        above = parent = self.parents[joint]
        is_placed = parent < 0 or self.together(joint, parent)
        while above >= 0:
            is_root = not len(below) and self.parents[above] < 0
            moves_none = not self.deform[above] and self.distance[above] > 0
            if moves_none and (is_root or not is_placed) and self.together(joint, above):
                self.rule_out(joint, f'not placed: at "{self.names[above]}"')
            above = self.parents[above]

    def _doubled(self) -> None:
        """Rule out the shorter of two chains on the same places."""
        bones = np.flatnonzero(self.deform)
        pairs = bones[cKDTree(self.joints[bones]).query_pairs(SAME_POSITION, output_type="ndarray")]
        place = np.arange(len(self.joints))
        for a, b in pairs:
            place[max(a, b)] = min(place[a], place[b])
        for a, b in pairs:
            is_alike = self.stem(a) == self.stem(b)
            partners = is_alike and self.plain[a][1] != self.plain[b][1]
            related = partners or self.parents[a] == self.parents[b]
            if related or self.is_below(a, b) or self.is_below(b, a):
                continue
            if not (self.deform[a] and self.deform[b]):
                continue
            chains = {j: self.chain(j) for j in (a, b)}
            places = {j: set(place[chain].tolist()) for j, chain in chains.items()}
            ranks = [
                ("twist" not in self.stem(j), len(places[j]), not self.is_top(j), -len(chains[j]))
                for j in (a, b)
            ]
            less, more = (a, b) if ranks[0] < ranks[1] else (b, a)
            marked = self.kinds[a][0] == self.kinds[b][0] == "bones"
            if marked or ranks[0] == ranks[1] or (self.ends_limb(less) and not is_alike):
                self.doubt(a, f'at the place of "{self.names[b]}"')
                self.doubt(b, f'at the place of "{self.names[a]}"')
            elif places[less] <= places[more]:
                self.rule_out(less, f'at the place of "{self.names[more]}"')

    def by_skin(self) -> None:
        """Doubt joints that were ruled out but are far nearer to some of the skin than any bone."""
        candidates = [
            j
            for j in np.flatnonzero(~self.deform).tolist()
            if self.distance[j] <= MAX_LACKING_DISTANCE
            and self.kinds[j][0] != "roots"
            and not (self.kinds[j][0] == "controls" and " in " in self.kinds[j][1])
        ]
        if not candidates or not self.deform.any():
            return
        area = np.linalg.norm(self.body.areas, axis=1)
        area /= area.sum()
        nearest = np.full(len(area), np.inf)
        for j in np.flatnonzero(self.deform).tolist():
            for end in self.bone_ends(j):
                away = distance_to_segment(self.body.points, self.joints[j], end)
                np.minimum(nearest, away, out=nearest)
        while candidates:
            parts = [area[self.to_joint(j) < LACKING_RATIO * nearest].sum() for j in candidates]
            part, j = max(parts), candidates.pop(int(np.argmax(parts)))
            if part < LACKING:
                return
            self.deform[j] = True
            self.doubt(j, f"nearest to {part:.0%} of the skin, but {self.reason[j]}")
            nearest = np.minimum(nearest, self.to_joint(j))
