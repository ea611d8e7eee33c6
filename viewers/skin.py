"""How a scene's points follow the joints: a few influences a point, blended linearly.

The page's view does the same sums in the browser, from the same arrays.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

MAX_INFLUENCES = 8


@dataclass(frozen=True, eq=False)
class Skin:
    """Influences of each point.

    Parameters
    ----------
    joints : array, shape (n, k), uint16
    weights : array, shape (n, k), float32
        Rows sum to one, or to zero where a point stands still.
    """

    joints: NDArray[np.uint16]
    weights: NDArray[np.float32]


def skin_of_weights(weights: ArrayLike) -> Skin:
    """Return the largest influences of each row of a weight matrix.

    Parameters
    ----------
    weights : array_like, shape (n, j)

    Returns
    -------
    Skin
        As many influences as the fullest row has, at most 8, renormalised.
    """
    weights = np.asarray(weights, float)
    count = int(np.clip((weights > 0).sum(axis=1).max(initial=1), 1, MAX_INFLUENCES))
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :count]
    largest = np.take_along_axis(weights, joints, axis=1)
    total = largest.sum(axis=1, keepdims=True)
    largest = np.divide(largest, total, out=np.zeros_like(largest), where=total > 0)
    return Skin(joints.astype(np.uint16), largest.astype(np.float32))


def rigid_skin(joints: ArrayLike) -> Skin:
    """Return a skin in which every point follows one joint, given as (n,) indices."""
    column = np.asarray(joints).astype(np.uint16)[:, None]
    return Skin(column, np.ones(column.shape, np.float32))


def moved(points: ArrayLike, skin: Skin, pose: ArrayLike) -> NDArray[np.float64]:
    """Return where a pose takes points.

    Parameters
    ----------
    points : array_like, shape (n, 3)
    skin : Skin
    pose : array_like, shape (j, 4, 4)

    Returns
    -------
    array, shape (n, 3), float64
    """
    points = np.asarray(points, float)
    pose = np.asarray(pose, float)[:, :3]
    blended = np.einsum("nk,nkab->nab", skin.weights, pose[skin.joints])
    result = np.einsum("nab,nb->na", blended[:, :, :3], points) + blended[:, :, 3]
    unweighted = skin.weights.sum(axis=1) == 0
    result[unweighted] = points[unweighted]
    return result


def distances_between(
    points: ArrayLike, skin: Skin, other: Skin, pose: ArrayLike
) -> NDArray[np.float64]:
    """Return the distance between the positions of each point in two skins, shape (n,)."""
    between = moved(points, skin, pose) - moved(points, other, pose)
    return np.asarray(np.linalg.norm(between, axis=1))


def turned(normals: ArrayLike, skin: Skin, pose: ArrayLike) -> NDArray[np.float64]:
    """Return unit normals, shape (n, 3), turned by a pose."""
    pose = np.array(pose, float)
    pose[:, :3, 3] = 0
    result = moved(normals, skin, pose)
    length = np.linalg.norm(result, axis=1, keepdims=True)
    return result / np.where(length > 0, length, 1)
