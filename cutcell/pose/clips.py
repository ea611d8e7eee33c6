"""Playing clips, and making a simple one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ParameterError
from ..rig import Skeleton
from ..rig.clip import Clip
from .kinematics import axis_rotation, checked_joint, forward_kinematics


def pose_at(clip: Clip, seconds: float) -> NDArray[np.float64]:
    """Return a clip's skinning matrices at a time, the clip playing over and over.

    Parameters
    ----------
    clip : Clip
    seconds : float
        Any time; the clip starts again whenever it has ended.

    Returns
    -------
    array, shape (j, 4, 4), float64

    Raises
    ------
    ParameterError
        A time that is not finite, or a clip without frames.
    """
    # The end is a separate frame, not yet the start again.
    duration = clip.duration
    if np.isfinite(seconds) and duration > 0 and not 0 <= seconds <= duration:
        seconds %= duration
    return clip.sample(seconds)


def swing(
    skeleton: Skeleton,
    joint: int,
    axis: str | ArrayLike,
    degrees: float,
    seconds: float = 2.0,
    fps: float = 30,
) -> Clip:
    """Make a clip in which one joint swings to both sides and returns.

    Parameters
    ----------
    skeleton : Skeleton
    joint : int
    axis : {"x", "y", "z"} or array_like, shape (3,)
        In the rig's space.
    degrees : float
        How far to each side.
    seconds : float
        Length of the clip, which loops without a jump.
    fps : float
        Frames a second.

    Returns
    -------
    Clip

    Raises
    ------
    ParameterError
        No such joint, or a length or rate that is not positive.
    """
    checked_joint(skeleton, joint)
    if not (np.isfinite(seconds) and np.isfinite(fps) and seconds > 0 and fps > 0):
        raise ParameterError(f"seconds and fps must be positive, not {seconds} and {fps}")
    times = np.linspace(0, seconds, max(round(seconds * fps), 1) + 1)
    rest = np.tile(np.eye(3), (len(skeleton.joints), 1, 1))
    frames = []
    for angle in degrees * np.sin(2 * np.pi * times / seconds):
        rotations = rest.copy()
        rotations[joint] = axis_rotation(axis, angle)
        frames.append(forward_kinematics(skeleton, rotations))
    return Clip(f"swing {skeleton.names[joint]}", times, np.array(frames))
