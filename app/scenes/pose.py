"""The character in a pose or a motion."""

from __future__ import annotations

from typing import Any

import numpy as np

from cutcell.rig import Clip
from viewers.character import pose_in_scene
from viewers.description import Description
from viewers.pose_scene import joint_turns, swing, turn

from ..state import State
from .common import character
from .memo import Memo

SWING_DEGREES = 50.0
POSED = ("pose", "compare")
"""The panels on which the character moves; on all others it rests."""


def pose(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Pose."""
    return Description(character(state, memo), pose=pose_of(state))


def pose_of(state: State) -> np.ndarray | None:
    """Return the pose that the sliders make, shape (j, 4, 4); None at rest or in motion."""
    from cutcell import forward_kinematics

    if state.moving or not state.posed:
        return None
    rotations = {
        joint: turn("z", z) @ turn("y", y) @ turn("x", x)
        for joint, (x, y, z) in state.turns.items()
        if any((x, y, z))
    }
    transforms = forward_kinematics(state.rig.skeleton, joint_turns(state.rig, rotations))
    return pose_in_scene(state.rig, transforms)


def clip_of(state: State) -> Clip | None:
    """Return the motion that is on: a clip of the rig, or a swing of the chosen joint."""
    if not state.moving or state.rig is None or state.panel not in POSED:
        return None
    if 0 <= state.clip < len(state.rig.clips):
        return state.rig.clips[state.clip]
    return swing(state.rig, state.joint, state.axis, SWING_DEGREES)


def clip_part(state: State, clip: Clip | None) -> dict[str, Any] | None:
    """Return a motion as the view is told it."""
    if clip is None or not len(clip.times):
        return None
    matrices = pose_in_scene(state.rig, clip.transforms).astype(np.float32)
    return {"times": clip.times.astype(np.float32), "matrices": matrices.ravel()}
