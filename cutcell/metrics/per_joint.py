"""Errors by joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..rig import Rig, Skeleton, TriangleMesh
from .counting import vertex_shares
from .deformation import deformation_error, parts_of
from .weight_error import checked_pair


@dataclass(frozen=True)
class JointRow:
    """One joint's part of the errors.

    Parameters
    ----------
    joint : int
    name : str
    predicted, reference : float
        The share of the whole mesh that the joint moves, 0 to 1.
    missing, extra : float
        Weight that the prediction lacks and has too much, as shares of the whole mesh. Over
        all joints both together sum to the L1 distance.
    deformation : float
        Squared distance when the joint turns, averaged over the vertices, the worst of the
        three axes; cm².
    axis : str
        That axis.
    """

    joint: int
    name: str
    predicted: float
    reference: float
    missing: float
    extra: float
    deformation: float
    axis: str


def joint_table(
    rig: Rig | tuple[TriangleMesh, Skeleton],
    predicted: ArrayLike,
    reference: ArrayLike,
    *,
    degrees: float = 30.0,
    count: str = "welded",
) -> tuple[JointRow, ...]:
    """List what each joint that may carry weight contributes, the greatest error first.

    Parameters
    ----------
    rig : Rig, or pair of TriangleMesh and Skeleton
    predicted, reference : array_like, shape (n, j)
    degrees, count
        See `deformation_error`.

    Returns
    -------
    tuple of JointRow

    Raises
    ------
    WeightsError, ParameterError
        See `deformation_error`.
    """
    mesh, skeleton = parts_of(rig)
    error = deformation_error(rig, predicted, reference, degrees, count=count)
    weights, targets = checked_pair(predicted, reference)
    share = vertex_shares(mesh, count)
    more, less = share @ np.maximum(weights - targets, 0), share @ np.maximum(targets - weights, 0)
    predicted_share, reference_share = share @ weights, share @ targets
    axis = error.turn_mean.argmax(axis=1)
    rows = [
        JointRow(
            int(j),
            skeleton.names[j],
            float(predicted_share[j]),
            float(reference_share[j]),
            float(less[j]),
            float(more[j]),
            float(error.turn_mean[j, axis[j]]),
            "xyz"[axis[j]],
        )
        for j in np.flatnonzero(skeleton.deform)
    ]
    return tuple(sorted(rows, key=lambda row: (-row.deformation, row.joint)))
