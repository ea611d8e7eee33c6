"""The character in a pose."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.pose import kinematics as motion
from cutcell.rig import Rig
from cutcell.rig.clip import Clip

from .character import attachments, body, bones, pose_in_scene
from .description import Description

SWING_SECONDS = 2.4
SWING_FRAMES = 48


def pose_scene(
    rig: Rig,
    weights: ArrayLike,
    transforms: ArrayLike,
    *,
    chosen: int | None = None,
    skeleton: bool = True,
) -> Description:
    """Return the scene of a posed character, plainly shaded.

    Parameters
    ----------
    rig : Rig
    weights : array_like, shape (n, j)
    transforms : array_like, shape (j, 4, 4)
        Skinning matrices in the rig's space, as from `cutcell.forward_kinematics`.
    chosen : int, optional
        The joint that is highlighted.
    skeleton : bool
    """
    actors = {
        "body": body(rig, weights),
        **attachments(rig),
        **bones(rig, chosen, skeleton),
    }
    return posed(Description(actors), rig, transforms)


def posed(description: Description, rig: Rig, transforms: ArrayLike | None) -> Description:
    """Return a description with its pose replaced by skinning matrices of the rig."""
    pose = None if transforms is None else pose_in_scene(rig, transforms)
    return replace(description, pose=pose)


def pose_at(rig: Rig, clip: Clip, time: float) -> NDArray[np.float64]:
    """Return a motion's pose at a time in seconds, in the scene's space, shape (j, 4, 4).

    The motion repeats.
    """
    return pose_in_scene(rig, motion.pose_at(clip, time))


def clip_in_scene(rig: Rig, clip: Clip) -> Clip:
    """Return a motion of the rig as one of the scene's poses."""
    return Clip(clip.name, motion=_InScene(clip, rig.world))


@dataclass(frozen=True, eq=False)
class _InScene:
    """A clip's motion in the space that a matrix (4, 4) leads to."""

    clip: Clip
    world: NDArray[np.float64]

    @property
    def joints(self) -> int:
        return self.clip.joints

    @property
    def duration(self) -> float:
        return self.clip.duration

    @property
    def times(self) -> NDArray[np.float64]:
        return self.clip.times

    def sample(self, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.world @ self.clip.sample(seconds) @ np.linalg.inv(self.world)


def turn(axis: str, degrees: float) -> NDArray[np.float64]:
    """Return the rotation (3, 3) by an angle about x, y or z, right-handed."""
    k = "xyz".index(axis)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    result = np.eye(3)
    a, b = (k + 1) % 3, (k + 2) % 3
    result[a, a] = result[b, b] = c
    result[a, b], result[b, a] = -s, s
    return result


def joint_turns(rig: Rig, turns: dict[int, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return one rotation a joint, shape (j, 3, 3): the given ones, else none.

    The given ones are about the scene's axes, so that "x" means the same for every rig.
    """
    rotations = np.broadcast_to(np.eye(3), (len(rig.skeleton.joints), 3, 3)).copy()
    world = rig.world[:3, :3]
    for joint, rotation in turns.items():
        rotations[joint] = np.linalg.inv(world) @ rotation @ world
    return rotations


def swing(rig: Rig, joint: int, axis: str, degrees: float) -> Clip:
    """Return a motion that turns one joint to and fro about an axis of the scene.

    Parameters
    ----------
    rig : Rig
    joint : int
    axis : {"x", "y", "z"}
    degrees : float
        How far to either side.
    """
    from cutcell import forward_kinematics

    phase = np.linspace(0, 2 * np.pi, SWING_FRAMES + 1)
    transforms = [
        forward_kinematics(rig.skeleton, joint_turns(rig, {joint: turn(axis, degrees * np.sin(p))}))
        for p in phase
    ]
    times = np.linspace(0, SWING_SECONDS, SWING_FRAMES + 1)
    return Clip("swing", times, np.array(transforms))
