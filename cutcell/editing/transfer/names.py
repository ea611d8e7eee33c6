"""Joints that stand for others: by their names, and where a vertex may not follow all."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from ...checks import check_kind
from ...errors import SkeletonError
from ...rig import Rig, Skeleton
from ...rig.names import same_names
from ..locks import joint_index


def joint_matrix(
    source: Skeleton,
    weights: NDArray[np.float64],
    target: Skeleton,
    exceptions: Mapping[str, str] | None = None,
) -> NDArray[np.float64]:
    """Return the matrix (j, t) that turns weights (n, j) of one skeleton into those of another.

    A joint without a partner gives its weight to the nearest one above it that has one.
    """
    if source is target:
        return np.eye(len(source.names))
    check_kind("names", {} if exceptions is None else exceptions, Mapping)
    partner = same_names(source.names, target.names)
    for name, other in (exceptions or {}).items():
        partner[joint_index(source, name)] = joint_index(target, other) if other else -1
    _climb(partner, source.parents)
    lost = (partner < 0) & (weights > 0).any(axis=0)
    if lost.any():
        raise SkeletonError(
            f"the target has no joint for {source.listed(lost)} of the source, nor for a joint "
            "above; name one (names, --names)"
        )
    return _matrix(partner, len(target.names))


def storable(weights: NDArray[np.float64], rig: Rig) -> NDArray[np.float64]:
    """Return weights (n, j) that a target's file can store, see `Rig.allowed`.

    A joint that a vertex may not follow gives its weight to the nearest one above it that the
    vertex may follow, or to the nearest joint where there is none above.
    """
    if rig.allowed is None:
        return weights
    barred = np.flatnonzero(((weights > 0) & ~rig.allowed).any(axis=1))
    if not len(barred):
        return weights
    weights, skeleton = weights.copy(), rig.skeleton
    sets, which = np.unique(rig.allowed[barred], axis=0, return_inverse=True)
    for number, allowed in enumerate(sets):
        if allowed.any():
            partner = np.where(allowed, np.arange(len(allowed)), -1)
            _climb(partner, skeleton.parents)
            lost, joints = np.flatnonzero(partner < 0), np.flatnonzero(allowed)
            away = cdist(skeleton.joints[lost], skeleton.joints[joints])
            partner[lost] = joints[away.argmin(axis=1)]
            rows = barred[which.ravel() == number]
            weights[rows] = weights[rows] @ _matrix(partner, len(partner))
    return weights


def _climb(partner: NDArray[np.intp], parents: NDArray[np.int32]) -> None:
    """Give each joint (j,) without a partner, which is -1, that of the nearest joint above."""
    while len(alone := np.flatnonzero((partner < 0) & (parents >= 0))):
        above = partner[parents[alone]]
        partner[alone] = above
        if (above < 0).all():
            break


def _matrix(partner: NDArray[np.intp], count: int) -> NDArray[np.float64]:
    """Return the matrix (j, t) that gives the weight of each joint (j,) to its partner, if any."""
    matrix = np.zeros((len(partner), count))
    matrix[partner >= 0, partner[partner >= 0]] = 1.0
    return matrix
