"""Dual quaternion skinning: joints are blended as rigid motions, which keeps the volume.

Kavan, Collins, Zara & O'Sullivan, "Geometric Skinning with Approximate Dual Quaternion Blending",
ACM Transactions on Graphics 27(4), 2008. Quaternions are (x, y, z, w). The page's view computes
the same from the same arrays (app/frontend/dual_quaternions.js).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from .kinematics import checked_skinning

SINGULAR = 1e-6
"""Determinant of a matrix without a nearest rotation, relative to the cube of its norm."""
HALF_TURN = 1e-4
"""Components and products of unit quaternions below this are taken for zero: the sign of a half
turn must not depend on rounding."""


def dual_quaternion_skinning(
    vertices: ArrayLike, weights: ArrayLike, transforms: ArrayLike
) -> NDArray[np.float64]:
    """Move each vertex by the blended dual quaternions of its joints.

    A bent or twisted joint keeps its volume, where linear blending of the same weights loses it.
    Joints with scale are moved linearly by it; where all joints of a vertex have the same scale,
    this equals the two phases of the paper.

    Parameters
    ----------
    vertices : array_like, shape (n, 3), float64
        Rest positions.
    weights : array_like, shape (n, j), float64
        Rows need not sum to one; where a row is all zero the vertex stays where it is.
    transforms : array_like, shape (j, 4, 4), float64
        Skinning matrices, as `forward_kinematics` returns. A matrix that mirrors or flattens has
        no nearest rotation, and is blended as if it did not rotate.

    Returns
    -------
    array, shape (n, 3), float64

    Raises
    ------
    ParameterError
        Shapes that do not fit each other.

    References
    ----------
    Kavan, Collins, Zara & O'Sullivan, "Geometric Skinning with Approximate Dual Quaternion
    Blending", ACM Transactions on Graphics 27(4), 2008.
    """
    points, shares, matrices = checked_skinning(vertices, weights, transforms)
    count = int((shares != 0).sum(axis=1).max(initial=0))
    if count == 0:
        return points.copy()
    joints = np.argsort(-np.abs(shares), axis=1, kind="stable")[:, :count]
    return blended(points, joints, np.take_along_axis(shares, joints, axis=1), matrices)[0]


def blended(
    points: NDArray[np.float64],
    joints: NDArray[np.integer],
    weights: NDArray[np.floating],
    matrices: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return points (n, 3) in a pose (j, 4, 4), and the quaternions (n, 4) that turn them.

    Each joint moves a point rigidly: by its rotation, and by the translation that takes the point
    where the joint's matrix takes it, scale included.

    Parameters
    ----------
    points : array, shape (n, 3)
    joints, weights : array, shape (n, k)
        The first joint of each row is the strongest, and decides the signs of the others.
    matrices : array, shape (j, 4, 4)
    """
    quaternions = rotation_quaternions(matrices)
    table = np.hstack([quaternions, _dual_parts(quaternions, matrices).reshape(-1, 16)])
    strongest = quaternions[joints[:, 0]]
    sums = np.zeros((len(points), 20))
    for column, share in zip(joints.T, weights.T, strict=True):
        is_opposite = np.einsum("nq,nq->n", quaternions[column], strongest) < -HALF_TURN
        sums += np.where(is_opposite, -share, share)[:, None] * table[column]
    real, by_point = sums[:, :4], sums[:, 4:].reshape(-1, 4, 4)
    dual = np.einsum("nab,nb->na", by_point[:, :, :3], points) + by_point[:, :, 3]
    length = np.linalg.norm(real, axis=1, keepdims=True)
    is_held = length > 0
    real = np.where(is_held, real, (0, 0, 0, 1)) / np.where(is_held, length, 1)
    dual /= np.where(is_held, length, 1)
    axis, other = real[:, :3], dual[:, :3]
    move = real[:, 3:] * other - dual[:, 3:] * axis + np.cross(axis, other)
    return Rotation.from_quat(real).apply(points) + move, real


def _dual_parts(
    quaternions: NDArray[np.float64], matrices: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the matrices (j, 4, 4) that take a point (x, y, z, 1) to twice a joint's dual part."""
    turns = Rotation.from_quat(quaternions).as_matrix()
    translation = matrices[:, :3].copy()
    translation[:, :, :3] -= turns
    axis, w = quaternions[:, :3], quaternions[:, 3, None, None]
    product = np.concatenate([w * np.eye(3), -axis[:, None]], axis=1)
    product[:, :3] += np.cross(axis[:, None], np.eye(3))
    return np.asarray(product @ translation, np.float64)


def rotation_quaternions(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the quaternions (j, 4) of the rotations that are nearest to matrices (j, 4, 4)."""
    linear = matrices[:, :3, :3]
    norm = np.linalg.norm(linear, axis=(1, 2))
    has_rotation = np.linalg.det(linear) > SINGULAR * norm**3
    left, _, right = np.linalg.svd(np.where(has_rotation[:, None, None], linear, np.eye(3)))
    result = np.asarray(Rotation.from_matrix(left @ right).as_quat(), np.float64).reshape(-1, 4)
    # A rotation has two quaternions: take the one whose w, else x, y or z, is positive.
    order = result[:, [3, 0, 1, 2]]
    first = np.argmax(np.abs(order) > HALF_TURN, axis=1)[:, None]
    return np.asarray(result * np.sign(np.take_along_axis(order, first, axis=1)), np.float64)
