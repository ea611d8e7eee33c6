"""Joints of a skeleton while they are judged: which are bones so far, and how they lie."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from ..names import plain
from ..skeleton import Skeleton
from .body import SURFACE_SPACING, Body

SAME_POSITION = 1e-3
"""Largest distance between joints at one place, relative to the longest side of the mesh."""
LIMB_END = r"\b(foot|feet|toes?|hoof|paw|ball|ankle|hand|wrist|palm|fingers?|claw)\b"
"""Names of bones beyond which a limb has no more that a control could move."""
BONE = "in or near the body"
LONG = 1.5
"""Lengths of the longest bone: the bone of a joint outside that is longer leads from a root."""
THROUGH_BODY = 0.5
"""Part of a link between two joints that must run in or near the body for it to be a bone."""
ALONG = np.linspace(0.1, 0.9, 9)
"""Samples along a link."""
NOTHING_BEYOND = 0.05
"""Lengths of the bone before: a last joint with less skin beyond it marks the end of that bone."""
OFF_BODY_DISTANCE = 0.04
"""Distance from the body beyond which a joint moves none of it, in longest sides."""


class Joints:
    """Joints in and around a body; all are bones at first."""

    def __init__(self, skeleton: Skeleton, body: Body) -> None:
        positions = body.to_unit(skeleton.joints)
        self.body = body
        self.names, self.parents = skeleton.names, skeleton.parents
        self.children = skeleton.children
        self.leaves_first = np.argsort(-skeleton.depth, kind="stable").tolist()
        self.joints = positions  # (j, 3), in longest sides of the mesh
        self.distance = np.zeros(len(positions))  # from the body
        self.deform = np.ones(len(positions), bool)
        self.doubtful = np.zeros(len(positions), bool)
        self.reason = [BONE] * len(positions)
        self.plain = [plain(name) for name in self.names]

    def rule_out(self, joint: int, reason: str) -> None:
        """Take a joint for none that deforms."""
        self.deform[joint], self.reason[joint] = False, reason

    def doubt(self, joint: int, reason: str) -> None:
        """Note why a joint that deforms might be none."""
        self.doubtful[joint], self.reason[joint] = True, reason

    def stem(self, joint: int) -> str:
        """Return the words of a joint's name, without numbers and sides."""
        return re.sub(r" *\d+", "", self.plain[joint][0])

    def ends_limb(self, joint: int) -> bool:
        """Return whether a joint is called a foot, hand or part of one."""
        return bool(re.search(LIMB_END, self.plain[joint][0]))

    def bones_below(self, joint: int) -> NDArray[np.intp]:
        """Return the next bones below a joint, also those below joints that are none."""
        below: list[int] = []
        waiting = self.children[joint].tolist()
        for child in waiting:
            if self.deform[child]:
                below.append(child)
            else:
                waiting += self.children[child].tolist()
        return np.array(below, np.intp)

    def is_top(self, joint: int) -> bool:
        """Return whether no bone is above a joint."""
        above = self.parents[joint]
        while above >= 0 and not self.deform[above]:
            above = self.parents[above]
        return bool(above < 0)

    def is_below(self, joint: int | np.integer, above: int | np.integer) -> bool:
        """Return whether a joint is another one or below it."""
        while joint >= 0 and joint != above:
            joint = self.parents[joint]
        return bool(joint == above)

    def together(self, joint: int, other: int) -> bool:
        """Return whether two joints are at one place."""
        return bool(np.abs(self.joints[joint] - self.joints[other]).max() <= SAME_POSITION)

    def chain(self, joint: int) -> list[int]:
        """Return a bone and all bones below it."""
        chain = [joint]
        for j in chain:
            chain += self.bones_below(j).tolist()
        return chain

    def is_longest(self, joint: int, below: NDArray[np.intp]) -> bool:
        """Return whether the only bone of a joint is far longer than all others."""
        bones = np.flatnonzero(self.deform & (self.parents >= 0) & (self.parents != joint))
        away = self.joints[bones] - self.joints[self.parents[bones]]
        lengths = np.linalg.norm(away, axis=1)[self.deform[self.parents[bones]]]
        length = np.linalg.norm(self.joints[below[0]] - self.joints[joint])
        return len(below) == 1 and bool(length > LONG * lengths.max(initial=0))

    def is_outside(self, joint: int) -> bool:
        """Return whether a joint lies outside of the body."""
        if 0 < self.distance[joint] <= SURFACE_SPACING and self.body.encloses(self.joints[joint]):
            return False
        return bool(self.distance[joint] > 0)

    def to_joint(self, joint: int) -> NDArray[np.float64]:
        """Measure from samples of the skin (s,) to a joint."""
        return np.linalg.norm(self.body.points - self.joints[joint], axis=1)

    def bone_ends(self, joint: int) -> NDArray[np.float64]:
        """Return where the bones of a joint end, shape (b, 3); a last one goes on as far."""
        below = [*self.bones_below(joint)] or [*self.children[joint]]
        if below:
            return self.joints[below]
        above = self.parents[joint] if self.parents[joint] >= 0 else joint
        return 2 * self.joints[[joint]] - self.joints[[above]]

    def leads_into_body(self, joint: int, others: NDArray[np.intp]) -> bool:
        """Return whether a link to any of the others runs through the body."""
        away = self.joints[others] - self.joints[joint]
        points = (self.joints[joint] + ALONG[:, None] * away[:, None]).reshape(-1, 3)
        near = self.body.to_surface(points) <= OFF_BODY_DISTANCE
        near[~near] = self.body.inside(points[~near])
        return bool((near.reshape(-1, len(ALONG)).mean(axis=1) >= THROUGH_BODY).any())

    def ends_a_bone(self, joint: int) -> bool:
        """Return whether a last joint lies on the skin at the end of a bone, or a little beyond."""
        parent = self.parents[joint]
        if parent < 0 or len(self.children[parent]) > 1:
            return False
        bone = self.joints[joint] - self.joints[parent]
        length = np.linalg.norm(bone)
        away = self.body.points - self.joints[joint]
        beyond = (away @ bone)[np.linalg.norm(away, axis=1) < length]
        is_last = len(beyond) > 0 and beyond.max() <= NOTHING_BEYOND * length**2
        return bool(is_last and not self.body.encloses(self.joints[joint]))
