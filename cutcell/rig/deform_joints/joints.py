"""Joints of a skeleton while they are judged: which are bones so far, and how they are related."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from ..names import plain
from ..skeleton import Skeleton

EXACT = 1e-3
"""Largest distance between joints at one place, relative to the longest side of the mesh."""
LIMB_END = r"\b(foot|feet|toes?|hoof|paw|ball|ankle|hand|wrist|palm|fingers?|claw)\b"
"""Names of bones beyond which a limb has no more that a control could move."""
BONE = "in or near the body"


class Joints:
    """Joints with positions (j, 3) in longest sides of the mesh; all are bones at first."""

    def __init__(self, skeleton: Skeleton, positions: NDArray[np.float64]) -> None:
        self.names, self.parents = skeleton.names, skeleton.parents
        self.children = skeleton.children
        self.leaves_first = np.argsort(-skeleton.depth, kind="stable").tolist()
        self.joints = positions
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
        return bool(np.abs(self.joints[joint] - self.joints[other]).max() <= EXACT)

    def chain(self, joint: int) -> list[int]:
        """Return a bone and all bones below it."""
        chain = [joint]
        for j in chain:
            chain += self.bones_below(j).tolist()
        return chain
