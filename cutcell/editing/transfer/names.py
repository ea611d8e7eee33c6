"""Joints of one skeleton that stand for those of another, by their names."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...checks import check_kind
from ...errors import SkeletonError
from ...rig import Skeleton
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
    while len(open_ends := np.flatnonzero((partner < 0) & (source.parents >= 0))):
        above = partner[source.parents[open_ends]]
        partner[open_ends] = above
        if (above < 0).all():
            break
    lost = (partner < 0) & (weights > 0).any(axis=0)
    if lost.any():
        raise SkeletonError(
            f"the target has no joint for {source.listed(lost)} of the source, nor for a joint "
            "above; name one (names, --names)"
        )
    matrix = np.zeros((len(source.names), len(target.names)))
    matrix[partner >= 0, partner[partner >= 0]] = 1.0
    return matrix
