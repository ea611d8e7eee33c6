"""Pose or motion of the character: as it is chosen, for the view, and commands."""

import numpy as np

from cutcell.pose import axis_rotation
from cutcell.rig import Clip
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.pose_scene import joint_turns, swing

from ..document.session import Session
from ..document.state import State
from ..server.protocol.sent import Motion, Rings

SWING_DEGREES = 50.0


def pose_of(state: State) -> np.ndarray | None:
    """Return the pose that the sliders make, shape (j, 4, 4); None at rest or in motion."""
    from cutcell import forward_kinematics

    if state.moving or not state.posed:
        return None
    rotations = {joint: rotation_of(angles) for joint, angles in state.turns.items() if any(angles)}
    transforms = forward_kinematics(state.rig.skeleton, joint_turns(state.rig, rotations))
    return pose_in_scene(state.rig, transforms)


def rotation_of(angles: tuple[float, float, float]) -> np.ndarray:
    """Return the rotation of a joint (3, 3) that is turned by degrees about x, y, then z."""
    x, y, z = angles
    return axis_rotation("z", z) @ axis_rotation("y", y) @ axis_rotation("x", x)


def angles_of(
    rotation: np.ndarray, near: tuple[float, float, float] = (0, 0, 0)
) -> tuple[float, float, float]:
    """Return those degrees about x, y and z of a rotation that are nearest to some others."""
    y = np.arcsin(np.clip(-rotation[2, 0], -1, 1))
    if abs(rotation[2, 0]) > 1 - 1e-9:
        # Only the sum or difference of the other two counts here: z keeps its value.
        z = np.radians(near[2])
        x = np.sign(y) * z + np.arctan2(np.sign(y) * rotation[0, 1], rotation[1, 1])
    else:
        x = np.arctan2(rotation[2, 1], rotation[2, 2])
        z = np.arctan2(rotation[1, 0], rotation[0, 0])
    one = np.degrees([x, y, z])
    other = np.degrees([x + np.pi, np.pi - y, z + np.pi])
    # The shortest way round; half a turn keeps its sign.
    ways = [(option - near + 180) % 360 - 180 for option in (one, other)]
    best = near + min(ways, key=lambda way: float(np.abs(way).sum()))
    best -= 360 * np.round(best / 360 * (1 - 1e-12))
    return tuple(float(round(angle, 1)) + 0.0 for angle in best)  # type: ignore[return-value]


def clip_of(state: State) -> Clip | None:
    """Return the current motion: a clip of the rig, or a swing of the chosen joint."""
    if not state.moving or state.rig is None or not state.open_panel.poses:
        return None
    return chosen_clip(state)


def chosen_clip(state: State) -> Clip:
    """Return the motion that is chosen, whether or not it is on."""
    if 0 <= state.clip < len(state.rig.clips):
        return state.rig.clips[state.clip]
    return swing(state.rig, state.joint, state.axis, SWING_DEGREES)


MAX_NUMBERS = 2**22
"""Largest motion that is sent to the browser (16 MB); longer ones are sent with fewer frames."""


TOGETHER = 64
"""Number of frames that are sampled at a time."""


def clip_part(state: State, clip: Clip | None, limit: int = MAX_NUMBERS) -> Motion | None:
    """Return a motion as a message for the view, with a limited number of numbers."""
    if clip is None or not len(times := clip.times):
        return None
    most = max(limit // max(16 * clip.joints, 1), 2)
    if len(times) > most:
        times = np.linspace(0, clip.duration, most)
    matrices = np.empty((len(times), clip.joints, 4, 4), np.float32)
    for first in range(0, len(times), TOGETHER):
        frames = slice(first, first + TOGETHER)
        matrices[frames] = pose_in_scene(state.rig, clip.sample(times[frames]))
    return {"times": times, "matrices": matrices.ravel()}


def gizmo_part(state: State) -> Rings | None:
    """Return the message for the rings that turn the chosen joint; None if it cannot be turned."""
    if state.rig is None or state.bare or state.panel != "pose" or state.moving or state.brush:
        return None
    rig, joint = state.rig, state.joint
    centre = rig.world[:3, :3] @ rig.skeleton.joints[joint] + rig.world[:3, 3]
    return {
        "joint": joint,
        "joints": len(rig.skeleton.joints),
        "centre": centre.tolist(),
        "below": np.flatnonzero(rig.skeleton.subtree[joint]).astype(np.int32),
    }


def rest(session: Session) -> None:
    """Put the character back as it was in the file."""
    session.state.param.update(turns={}, moving=False, playing=False)


def play(session: Session) -> None:
    """Play the chosen motion, or pause it; on the panel Pose if the open one moves nothing."""
    state = session.state
    if state.bare:
        return
    if state.moving and state.open_panel.poses:
        state.playing = not state.playing
    else:
        panel = state.panel if state.open_panel.poses else "pose"
        state.param.update(panel=panel, moving=True, playing=True)
