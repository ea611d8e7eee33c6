"""Twist joints at the far end of the bone that they twist, as Auto-Rig Pro's `leg_twist`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...rig import Skeleton

AT_END = 0.1
"""Such a joint is at most this part of the bone's length from the bone's end."""


def with_twists_in_chain(
    skeleton: Skeleton, joints: NDArray[np.float64]
) -> tuple[Skeleton, NDArray[np.float64]]:
    """Move twist joints from the end of a bone to its middle: they move the half up to the end.

    The bone's parent joint then leads on to the twist joint, and that to the bone's end.

    Shapes: joints (j, 3); returns these, too.
    """
    parents, deform, places = skeleton.parents.copy(), skeleton.deform, joints.copy()
    is_twist = deform & np.array(["twist" in name.lower() for name in skeleton.names])
    is_twist &= (skeleton.subtree & deform).sum(axis=1) == 1
    has_bone = (parents >= 0) & deform[parents] & ~is_twist
    length = np.where(has_bone, np.linalg.norm(joints - joints[parents], axis=1), 0.0)
    for twist in np.flatnonzero(is_twist):
        away = np.linalg.norm(joints - joints[twist], axis=1)
        # The bone of its parent joint, or of a sibling.
        is_near = (parents == parents[twist]) | (parents[parents] == parents[twist])
        at_end = is_near & (away < AT_END * length)
        if at_end.any():
            end = np.where(at_end, away, np.inf).argmin()
            start = parents[end]
            places[twist] = (joints[start] + joints[end]) / 2
            parents[twist], parents[end] = start, twist
    return replace(skeleton, parents=parents), places
