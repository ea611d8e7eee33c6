"""The error in random poses, which RigNet and UniRig measure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from cutcell.checks import check_integer, check_number
from cutcell.pose import forward_kinematics
from cutcell.rig import Rig, Skeleton
from cutcell.rig.mesh import vertex_shares

from .clips import squared_distances
from .deformation import checked_fit

POSES = 10
"""Number of poses, RigNet's."""
DEGREES = 30.0
"""Largest rotation about each axis, UniRig's."""
MAX_POSES = 10_000


@dataclass(frozen=True)
class PoseError:
    """Distances between two sets of weights in random poses; the longest side being 1.

    Parameters
    ----------
    mean : float
        Distance, averaged over vertices and poses.
    largest : float
        The greatest distance of any vertex in any pose.
    mean_square : float
        Squared distance, averaged over vertices and poses.
    """

    mean: float
    largest: float
    mean_square: float


def pose_error(
    rig: Rig,
    predicted: ArrayLike,
    reference: ArrayLike,
    *,
    poses: int = POSES,
    degrees: float = DEGREES,
    seed: int = 0,
    count: str = "vertices",
) -> PoseError:
    """Pose a rig at random with both weights and compare where the surface goes.

    Parameters
    ----------
    rig : Rig
    predicted, reference : array_like, shape (n, j)
        Rows sum to one, or to zero: such vertices stay at their rest position.
    poses : int
        Number of poses.
    degrees : float
        Each joint turns by a rotation vector with components of up to this, 0 to 180.
    seed : int
        The same seed and skeleton give the same poses.
    count : {"welded", "vertices"}
        See `vertex_shares`.

    Returns
    -------
    PoseError

    Raises
    ------
    SkeletonError
        No joints.
    WeightsError
        Weights that do not fit the rig or each other.
    ParameterError
        A number out of range, or an unknown `count`.

    References
    ----------
    Xu et al. 2020 (RigNet), "dist"; Zhang et al. 2025 (UniRig), `vertex_loss` of its code.
    """
    weights, targets = checked_fit(rig, predicted, reference)
    poses = check_integer("poses", poses, 1, MAX_POSES)
    degrees = check_number("degrees", degrees, 0, 180)
    share = vertex_shares(rig.mesh, count)
    mean = largest = mean_square = 0.0
    for transforms in _random_poses(rig.skeleton, poses, degrees, seed):
        squares = squared_distances(rig.mesh, weights, targets, transforms)
        distances = np.sqrt(squares)
        mean += float(share @ distances) / poses
        mean_square += float(share @ squares) / poses
        largest = max(largest, float(distances[share > 0].max()))
    return PoseError(mean, largest, mean_square)


def _random_poses(
    skeleton: Skeleton, poses: int, degrees: float, seed: int
) -> list[NDArray[np.float64]]:
    """Return skinning matrices (j, 4, 4) of random poses."""
    shape = (poses, len(skeleton.joints), 3)
    turns = np.random.default_rng(seed).uniform(-degrees, degrees, shape)
    return [
        forward_kinematics(skeleton, Rotation.from_rotvec(vectors, degrees=True).as_matrix())
        for vectors in turns
    ]
