"""Pose or motion of the character: as it is chosen, for the view, and commands."""

from collections.abc import Mapping

import numpy as np

from cutcell.editing import SavedPose
from cutcell.pose import axis_rotation, forward_kinematics, pose_at
from cutcell.rig import Clip, Rig
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.pose_scene import joint_turns, swing, through_poses

from ..document.session import Session
from ..document.state import State
from ..server.protocol.sent import Motion, Rings
from ..widgets.text import unique_names

SWING_DEGREES = 50.0
SWING, POSES = -1, -2
"""Numbers of the motions that are no clips of the file: a swing, and the saved poses in turn."""

Turn = tuple[float, float, float]
"""Degrees about x, y and z of the scene."""


def pose_of(state: State) -> np.ndarray | None:
    """Return the pose that the sliders make, shape (j, 4, 4); None at rest or in motion."""
    if state.moving or not state.posed:
        return None
    return pose_in_scene(state.rig, turned(state.rig, state.turns))


def turned(rig: Rig, turns: Mapping[int, Turn]) -> np.ndarray:
    """Return the skinning matrices (j, 4, 4), in the rig's space, of joints that are turned."""
    rotations = {joint: rotation_of(angles) for joint, angles in turns.items() if any(angles)}
    return forward_kinematics(rig.skeleton, joint_turns(rig, rotations))


def clip_names(rig: Rig) -> list[str]:
    """Return the names of the clips of a rig, of which none comes twice."""
    return unique_names([clip.name or f"clip {i}" for i, clip in enumerate(rig.clips)])


def saved_turns(rig: Rig, pose: SavedPose) -> dict[int, Turn]:
    """Return the turns of a saved pose by joint, of those joints that the rig has."""
    names, turns = rig.skeleton.names, pose.turns.items()
    return {names.index(name): turn for name, turn in turns if name in names and any(turn)}


def saved_pose(rig: Rig, pose: SavedPose) -> np.ndarray:
    """Return the skinning matrices (j, 4, 4) of a saved pose; at rest without its clip."""
    names = clip_names(rig)
    if pose.clip in names:
        return pose_at(rig.clips[names.index(pose.clip)], pose.seconds)
    return turned(rig, saved_turns(rig, pose))


def rotation_of(angles: Turn) -> np.ndarray:
    """Return the rotation of a joint (3, 3) that is turned by degrees about x, y, then z."""
    x, y, z = angles
    return axis_rotation("z", z) @ axis_rotation("y", y) @ axis_rotation("x", x)


def angles_of(rotation: np.ndarray, near: Turn = (0, 0, 0)) -> Turn:
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
    """Return the current motion: a clip of the rig, the saved poses, or a swing of the joint."""
    if not state.moving or state.rig is None or not state.open_panel.poses:
        return None
    return chosen_clip(state)


def chosen_clip(state: State) -> Clip:
    """Return the motion that is chosen, whether or not it is on."""
    if 0 <= state.clip < len(state.rig.clips):
        return state.rig.clips[state.clip]
    if state.clip == POSES:
        inputs = (state.rig, str(state.edits.poses))  # other edits leave the motion as it is
        return state.memo("poses", inputs, lambda: _through(state))
    return swing(state.rig, state.joint, state.axis, SWING_DEGREES)


def _through(state: State) -> Clip:
    poses = state.edits.poses.values()
    return through_poses(state.rig, [saved_pose(state.rig, pose) for pose in poses])


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
