"""Moving a rig: rotations of joints, linear blend skinning, and clips played or made."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from ..errors import ParameterError
from ..rig import Clip, Skeleton
from ..rig.checks import as_array
from ..rig.transforms import composed

AXIS_VECTORS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def forward_kinematics(skeleton: Skeleton, rotations: ArrayLike) -> NDArray[np.float64]:
    """Turn each joint about its own rest position, and all below it along with it.

    Parameters
    ----------
    skeleton : Skeleton
    rotations : array_like, shape (j, 3, 3), float64
        Rotation of each joint, about the axes of the rig's space.

    Returns
    -------
    array, shape (j, 4, 4), float64
        Skinning matrices: rest point held by joint j -> posed point.

    Raises
    ------
    ParameterError
        Rotations of another shape, or not finite.
    """
    count = len(skeleton.joints)
    turns = _numbers(rotations, (count, 3, 3), "rotations")
    local = np.tile(np.eye(4), (count, 1, 1))
    local[:, :3, :3] = turns
    local[:, :3, 3] = skeleton.joints - np.einsum("jab,jb->ja", turns, skeleton.joints)
    return composed(local, skeleton.parents)


def rotate_joint(
    skeleton: Skeleton, joint: int, axis: str | ArrayLike, degrees: float
) -> NDArray[np.float64]:
    """Turn one joint; the rest of the skeleton follows.

    Parameters
    ----------
    skeleton : Skeleton
    joint : int
        Which joint turns.
    axis : {"x", "y", "z"} or array_like, shape (3,)
        In the rig's space; need not have unit length.
    degrees : float
        Counter-clockwise seen from the tip of the axis.

    Returns
    -------
    array, shape (j, 4, 4), float64
        Skinning matrices.

    Raises
    ------
    ParameterError
        No such joint, or an axis without direction.
    """
    rotations = np.tile(np.eye(3), (len(skeleton.joints), 1, 1))
    rotations[checked_joint(skeleton, joint)] = axis_rotation(axis, degrees)
    return forward_kinematics(skeleton, rotations)


def axis_rotation(axis: str | ArrayLike, degrees: float) -> NDArray[np.float64]:
    """Return the rotation matrix, shape (3, 3), about an axis."""
    if isinstance(axis, str):
        if axis not in AXIS_VECTORS:
            raise ParameterError(f'axis "{axis}" is none of x, y, z')
        axis = AXIS_VECTORS[axis]
    direction = _numbers(axis, (3,), "axis")
    length = np.linalg.norm(direction)
    if length == 0:
        raise ParameterError("axis is (0, 0, 0), which has no direction")
    if not np.isfinite(degrees):
        raise ParameterError(f"degrees must be a finite number, not {degrees}")
    vector = np.radians(degrees) * direction / length
    return np.asarray(Rotation.from_rotvec(vector).as_matrix(), np.float64)


def checked_joint(skeleton: Skeleton, joint: int) -> int:
    """Return the joint's number if the skeleton has it."""
    if not 0 <= joint < len(skeleton.joints):
        raise ParameterError(
            f"there is no joint {joint}: the skeleton's are 0 to {len(skeleton.joints) - 1}"
        )
    return int(joint)


def _numbers(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    array = as_array(value, np.float64, shape, name, ParameterError)
    if not np.isfinite(array).all():
        raise ParameterError(f"{name} holds values that are not finite numbers")
    return array


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
    angles = degrees * np.sin(2 * np.pi * times / seconds)
    frames = [rotate_joint(skeleton, joint, axis, angle) for angle in angles.tolist()]
    return Clip(f"swing {skeleton.names[joint]}", times, frames)


def linear_blend_skinning(
    vertices: ArrayLike, weights: ArrayLike, transforms: ArrayLike
) -> NDArray[np.float64]:
    """Move each vertex by the weighted mean of the transforms of its joints.

    Parameters
    ----------
    vertices : array_like, shape (n, 3), float64
        Rest positions.
    weights : array_like, shape (n, j), float64
        Rows sum to one; where a row is all zero the vertex stays where it is.
    transforms : array_like, shape (j, 4, 4), float64
        Skinning matrices, as `forward_kinematics` returns.

    Returns
    -------
    array, shape (n, 3), float64

    Raises
    ------
    ParameterError
        Shapes that do not fit each other.
    """
    points, shares, matrices = checked_skinning(vertices, weights, transforms)
    blended = (shares @ matrices[:, :3].reshape(-1, 12)).reshape(-1, 3, 4)
    posed = np.einsum("nab,nb->na", blended[:, :, :3], points) + blended[:, :, 3]
    is_weighted = np.abs(shares).sum(axis=1, keepdims=True) > 0
    return np.where(is_weighted, posed, points)


def checked_skinning(
    vertices: ArrayLike, weights: ArrayLike, transforms: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return vertices (n, 3), weights (n, j) and matrices (j, 4, 4) if they fit each other."""
    points = np.asarray(vertices, np.float64)
    shares = np.asarray(weights, np.float64)
    matrices = np.asarray(transforms, np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ParameterError(f"vertices have the shape {points.shape}, expected (n, 3)")
    if shares.ndim != 2 or matrices.shape != (shares.shape[1], 4, 4):
        raise ParameterError(
            f"transforms have the shape {matrices.shape}, but the weights, {shares.shape}, "
            "need (j, 4, 4) for (n, j)"
        )
    if len(shares) != len(points):
        raise ParameterError(f"{len(points)} vertices but {len(shares)} rows of weights")
    return points, shares, matrices
