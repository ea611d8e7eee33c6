"""The error that is seen when joints turn (paper section 4.3.1, "Rest-Pose Deformation Error")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.checks import check_choice, check_number
from cutcell.errors import ParameterError, WeightsError
from cutcell.rig import Rig, Skeleton, TriangleMesh
from cutcell.rig.mesh import vertex_shares
from cutcell.runtime.progress import Progress, silent

from .weight_error import checked_pair

AXES = ("x", "y", "z")
Turned = Literal["deform", "all"]
TURNED: tuple[Turned, ...] = get_args(Turned)
"""Named choices of the joints to turn."""
CM2 = 1e4
"""Square centimetres in a square metre: the longest side of a mesh counts as 1 m."""
ROUNDING = 1e-12
"""Differences of sums of weights up to this are none."""
BLOCK_NUMBERS = 1 << 20
"""Numbers of each array of a block of vertices: 8 MB."""


@dataclass(frozen=True)
class Turn:
    """Errors of turning one joint about one axis.

    Parameters
    ----------
    joint : int
    name : str
    axis : str
        "x", "y" or "z", of the rig's space.
    mean : float
        Squared distance averaged over the vertices, cm².
    largest : float
        The greatest of any vertex, cm².
    """

    joint: int
    name: str
    axis: str
    mean: float
    largest: float


@dataclass(frozen=True, eq=False)
class DeformationError:
    """The deformation error, whole and in parts; all in cm², the longest side being 1 m.

    Parameters
    ----------
    mean : float
        E_def: over the vertices, the mean of `vertex`.
    vertex : array, shape (n,)
        The greatest squared distance over all turned joints and axes.
    joint : array, shape (n,), int32
        The joint whose turn does that.
    turn_mean, turn_largest : arrays, shape (j, 3)
        For each joint and axis the mean and the greatest over the vertices; zero for
        joints that were not turned.
    names : tuple of str
    """

    mean: float
    vertex: NDArray[np.float64]
    joint: NDArray[np.int32]
    turn_mean: NDArray[np.float64]
    turn_largest: NDArray[np.float64]
    names: tuple[str, ...]

    def worst(self, count: int = 5) -> list[Turn]:
        """List the turns with the greatest mean error, worst first; at most `count`."""
        order = np.argsort(-self.turn_mean, axis=None, kind="stable")[:count]
        return [
            Turn(
                int(at) // 3,
                self.names[at // 3],
                AXES[at % 3],
                float(self.turn_mean.flat[at]),
                float(self.turn_largest.flat[at]),
            )
            for at in order
            if self.turn_mean.flat[at] > 0
        ]


def deformation_error(
    rig: Rig | tuple[TriangleMesh, Skeleton],
    predicted: ArrayLike,
    reference: ArrayLike,
    degrees: float = 30.0,
    *,
    joints: Turned | ArrayLike = "deform",
    count: str = "welded",
    progress: Progress = silent,
) -> DeformationError:
    """Turn every joint about x, y and z and compare where two sets of weights put the surface.

    Turning joint j moves a vertex v by (R - I)(v - p_j) times the weight S_j that it gives
    to j and all joints below. About the x axis that difference has the squared length

        2 (1 - cos θ) (q_y² + q_z²) (S_j - S_j')²,   q = v - p_j

    so no vertex needs to be moved. A vertex without weight stays where it is.

    Parameters
    ----------
    rig : Rig, or pair of TriangleMesh and Skeleton
    predicted, reference : array_like, shape (n, j)
        Rows sum to one, or to zero.
    degrees : float
        θ, how far each joint turns, 0 to 180.
    joints : {"deform", "all"} or array_like of int
        The joints to turn. "deform": those that may carry weight (`Skeleton.deform`). "all": every
        joint of the skeleton, as in the paper. Else their numbers.
    count : {"welded", "vertices"}
        See `vertex_shares`.
    progress : callable
        See `cutcell.runtime.progress`; the stage is called "deformation".

    Returns
    -------
    DeformationError

    Raises
    ------
    SkeletonError
        No joints.
    WeightsError
        Weights that do not fit the rig or each other.
    ParameterError
        An angle out of range, an unknown word, or joints that the skeleton does not have.

    References
    ----------
    Paper section 4.3.1.
    """
    mesh, skeleton = parts_of(rig)
    weights, targets = checked_fit(rig, predicted, reference)
    degrees = check_number("degrees", degrees, 0, 180)
    turned = _checked_joints(joints, skeleton)
    share = vertex_shares(mesh, count)

    chord = squared_chord(mesh, degrees)
    vertex = np.zeros(len(weights))
    joint = np.full(len(weights), turned[0], np.int32)
    turn_mean = np.zeros((len(skeleton.joints), 3))
    turn_largest = np.zeros((len(skeleton.joints), 3))
    below = skeleton.subtree[turned].T.astype(np.float64)
    step = max(1, BLOCK_NUMBERS // len(skeleton.joints))
    for first in range(0, len(weights), step):
        progress("deformation", first / len(weights))
        part = slice(first, first + step)
        moved = (weights[part] - targets[part]) @ below  # (block, turned): S - S'
        for k, j in enumerate(turned):
            rows = np.flatnonzero(np.abs(moved[:, k]) > ROUNDING)
            at = first + rows
            error = turn_error(mesh.vertices[at], skeleton.joints[j], moved[rows, k], chord)
            turn_mean[j] += share[at] @ error
            counted = error[share[at] > 0]
            turn_largest[j] = np.maximum(turn_largest[j], counted.max(axis=0, initial=0))
            largest = error.max(axis=1)
            higher = largest > vertex[at]
            vertex[at[higher]] = largest[higher]
            joint[at[higher]] = j
    return DeformationError(
        float(share @ vertex), vertex, joint, turn_mean, turn_largest, skeleton.names
    )


def squared_chord(mesh: TriangleMesh, degrees: float) -> float:
    """Return the factor of `turn_error`: the squared chord of a turn, in cm² at a 1 m mesh."""
    return float(2 * (1 - np.cos(np.radians(degrees))) * CM2 / longest_side(mesh) ** 2)


def turn_error(
    points: NDArray[np.float64],
    joint: NDArray[np.float64],
    moved: NDArray[np.float64],
    chord: float,
) -> NDArray[np.float64]:
    """Return the squared distances (p, 3) of points (p, 3) as a joint (3,) turns about x, y, z.

    `moved` (p,) is the difference of the weights that follow the joint.
    """
    arm = (points - joint) ** 2
    off_axis = arm.sum(axis=1, keepdims=True) - arm
    return np.asarray(chord * off_axis * moved[:, None] ** 2)


def parts_of(rig: Rig | tuple[TriangleMesh, Skeleton]) -> tuple[TriangleMesh, Skeleton]:
    """Return mesh and skeleton of a rig, or of such a pair."""
    if isinstance(rig, Rig):
        return rig.mesh, rig.skeleton
    return rig


def checked_fit(
    rig: Rig | tuple[TriangleMesh, Skeleton], predicted: ArrayLike, reference: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return both as arrays (n, j) of weights for the vertices and joints of a rig."""
    mesh, skeleton = parts_of(rig)
    (rig if isinstance(rig, Rig) else skeleton).require_joints()
    weights, targets = checked_pair(predicted, reference)
    expected = (len(mesh.vertices), len(skeleton.joints))
    if weights.shape != expected:
        raise WeightsError(
            f"the weights have the shape {weights.shape}, but the rig has {expected[0]} "
            f"vertices and {expected[1]} joints"
        )
    return weights, targets


def longest_side(mesh: TriangleMesh) -> float:
    """Return the longest side of the bounding box, in the file's units."""
    low, high = mesh.bounds
    return float((high - low).max())


def _checked_joints(joints: Turned | ArrayLike, skeleton: Skeleton) -> NDArray[np.intp]:
    if isinstance(joints, str):
        every = check_choice("joints", joints, TURNED) == "all"
        return np.flatnonzero(skeleton.deform | every)
    turned = np.atleast_1d(np.asarray(joints))
    whole = np.issubdtype(turned.dtype, np.integer) and turned.ndim == 1 and turned.size > 0
    if not whole or turned.min() < 0 or turned.max() >= len(skeleton.joints):
        raise ParameterError(
            f"joints must be a list of numbers from 0 to {len(skeleton.joints) - 1}"
        )
    return turned
