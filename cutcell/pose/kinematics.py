"""Forward kinematics: from rotations of joints to skinning matrices."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ParameterError
from ..rig import Skeleton
from ..rig.transforms import composed

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def forward_kinematics(
    skeleton: Skeleton, rotations: ArrayLike, translation: ArrayLike | None = None
) -> NDArray[np.float64]:
    """Turn each joint about its own rest position, and all below it along with it.

    Parameters
    ----------
    skeleton : Skeleton
    rotations : array_like, shape (j, 3, 3), float64
        Rotation of each joint, about the axes of the rig's space.
    translation : array_like, shape (3,), optional
        Moves the whole character, in the rig's units.

    Returns
    -------
    array, shape (j, 4, 4), float64
        Skinning matrices: rest point held by joint j -> posed point.

    Raises
    ------
    ParameterError
        Rotations or translation of another shape, or not finite.
    """
    count = len(skeleton.joints)
    turns = _numbers(rotations, (count, 3, 3), "rotations")
    local = np.tile(np.eye(4), (count, 1, 1))
    local[:, :3, :3] = turns
    local[:, :3, 3] = skeleton.joints - np.einsum("jab,jb->ja", turns, skeleton.joints)
    transforms = composed(local, skeleton.parents)
    if translation is not None:
        transforms[:, :3, 3] += _numbers(translation, (3,), "translation")
    return transforms


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
    """Return the rotation matrix, shape (3, 3), about an axis (formula of Rodrigues)."""
    if isinstance(axis, str):
        if axis not in AXES:
            raise ParameterError(f'axis "{axis}" is none of x, y, z')
        axis = AXES[axis]
    direction = _numbers(axis, (3,), "axis")
    length = np.linalg.norm(direction)
    if length == 0:
        raise ParameterError("axis is (0, 0, 0), which has no direction")
    if not np.isfinite(degrees):
        raise ParameterError(f"degrees must be a finite number, not {degrees}")
    x, y, z = direction / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)


def checked_joint(skeleton: Skeleton, joint: int) -> int:
    """Return the joint's number if the skeleton has it."""
    if not 0 <= joint < len(skeleton.joints):
        raise ParameterError(
            f"there is no joint {joint}: the skeleton's are 0 to {len(skeleton.joints) - 1}"
        )
    return int(joint)


def _numbers(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray[np.float64]:
    try:
        array = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        raise ParameterError(f"{name} must be an array of numbers") from None
    if array.shape != shape:
        raise ParameterError(f"{name} has the shape {array.shape}, expected {shape}")
    if not np.isfinite(array).all():
        raise ParameterError(f"{name} holds values that are not finite numbers")
    return array
