"""The character in a pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from cutcell.pose import axis_rotation, forward_kinematics
from cutcell.pose.dual_quaternions import rotation_quaternions
from cutcell.rig import Rig
from cutcell.rig.clip import Clip, Derived, Motion
from cutcell.rig.transforms import composed, relative

from .character import character, pose_in_scene
from .description import Apart, Description
from .error_scene import error_legend, error_limits, error_look, gap_between, millimetres
from .skin import Skin

SWING_SECONDS = 2.4
SWING_FRAMES = 48
HOLD_SECONDS = 0.6
"""How long a motion through several poses stays in each."""
MOVE_SECONDS = 0.6
MOVE_FRAMES = 18
"""The way from one pose to the next."""


def pose_scene(
    rig: Rig,
    weights: ArrayLike,
    transforms: ArrayLike,
    *,
    reference: ArrayLike | None = None,
    chosen: int | None = None,
    skeleton: bool = True,
) -> Description:
    """Return the scene of a posed character, plainly shaded or in the colours of an error.

    Parameters
    ----------
    rig : Rig
    weights : array_like, shape (n, j)
    transforms : array_like, shape (j, 4, 4)
        Skinning matrices in the rig's space, as from `cutcell.forward_kinematics`.
    reference : array_like, shape (n, j), optional
        Weights by which the positions differ from those shown: the error is coloured.
    chosen : int, optional
        The joint that is highlighted.
    skeleton : bool
    """
    pose, style, legend = pose_in_scene(rig, transforms), dict[str, Any](), None
    if reference is not None:
        limits = error_limits(gap_between(rig, weights, reference).lengths(pose))
        apart = Apart(Skin.of_weights(reference), millimetres(rig))
        style, legend = error_look(len(rig.mesh.vertices), apart, limits), error_legend(limits)
    return Description(character(rig, weights, chosen, skeleton, **style), pose=pose, legend=legend)


def clip_in_scene(rig: Rig, clip: Clip) -> Clip:
    """Return a motion of the rig as one of the scene's poses."""
    return Clip(clip.name, motion=_InScene(clip, rig.world))


@dataclass(frozen=True, eq=False)
class _InScene(Derived):
    """A motion in the space that a matrix (4, 4) leads to."""

    motion: Motion
    world: NDArray[np.float64]

    def sample(self, seconds: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.world @ self.motion.sample(seconds) @ np.linalg.inv(self.world)


def joint_turns(rig: Rig, turns: dict[int, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return a rotation for each joint, shape (j, 3, 3), from those of some in the scene's space.

    In that space "x" means the same for every rig.
    """
    rotations = np.broadcast_to(np.eye(3), (len(rig.skeleton.joints), 3, 3)).copy()
    world = rig.world[:3, :3]
    for joint, rotation in turns.items():
        rotations[joint] = np.linalg.inv(world) @ rotation @ world
    return rotations


def swing(rig: Rig, joint: int, axis: str, degrees: float) -> Clip:
    """Return a motion that turns one joint to both sides about an axis of the scene.

    Parameters
    ----------
    rig : Rig
    joint : int
    axis : {"x", "y", "z"}
    degrees : float
        Angle to either side.
    """
    angles = degrees * np.sin(np.linspace(0, 2 * np.pi, SWING_FRAMES + 1))
    turns = [joint_turns(rig, {joint: axis_rotation(axis, angle)}) for angle in angles.tolist()]
    times = np.linspace(0, SWING_SECONDS, SWING_FRAMES + 1)
    return Clip("swing", times, [forward_kinematics(rig.skeleton, turn) for turn in turns])


def through_poses(rig: Rig, poses: Sequence[NDArray[np.float64]]) -> Clip:
    """Return a motion from rest through some poses and back, which stays in each for a while.

    Parameters
    ----------
    rig : Rig
    poses : sequence of arrays, shape (j, 4, 4)
        Skinning matrices in the rig's space.
    """
    joints, parents = rig.skeleton.joints, rig.skeleton.parents
    rest = np.tile(np.eye(4), (len(joints), 1, 1))
    stops = [_parts(relative(pose, parents), joints) for pose in (rest, *poses, rest)]
    times, frames, start = [0.0], [rest], 0.0
    for (turns, linear, places), (next_turns, next_linear, next_places) in pairwise(stops):
        way = (next_turns * turns.inv()).as_rotvec()  # the shortest
        for part in np.arange(1, MOVE_FRAMES + 1) / MOVE_FRAMES:
            turn = (Rotation.from_rotvec(part * way) * turns).as_matrix()
            local = np.tile(np.eye(4), (len(joints), 1, 1))
            local[:, :3, :3] = turn @ (linear + part * (next_linear - linear))
            local[:, :3, 3] = places + part * (next_places - places)
            local[:, :3, 3] -= np.einsum("jab,jb->ja", local[:, :3, :3], joints)
            frames.append(composed(local, parents))
            times.append(start + part * MOVE_SECONDS)
        start += MOVE_SECONDS + HOLD_SECONDS
        frames.append(frames[-1])
        times.append(start)
    return Clip("poses", times, frames)


def _parts(
    local: NDArray[np.float64], joints: NDArray[np.float64]
) -> tuple[Rotation, NDArray[np.float64], NDArray[np.float64]]:
    """Return how transforms relative to parents (j, 4, 4) turn, scale, and move joints (j, 3)."""
    turns = Rotation.from_quat(rotation_quaternions(local))
    places = np.einsum("jab,jb->ja", local[:, :3, :3], joints) + local[:, :3, 3]
    return turns, turns.inv().as_matrix() @ local[:, :3, :3], places
