"""Skinning weights from bone distances (paper section 3.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..checks import check_choice, check_integer, check_number
from ..errors import ParameterError
from ..geodesics import BoneDistances
from .kernel import paper_kernel
from .prune import prune

FALLOFFS = ("paper",)
MOST_INFLUENCES = 1024


def skinning_weights(
    distances: BoneDistances,
    *,
    falloff: str = "paper",
    alpha: float = 0.5,
    max_influences: int | None = 4,
    threshold: float = 0.0,
) -> NDArray[np.float64]:
    """Turn distances into weights.

    Parameters
    ----------
    distances : BoneDistances
    falloff : {"paper"}
        The kernel: equation 1 of the paper.
    alpha : float
        Its smoothness, 0 to 1.
    max_influences : int or None
        Joints a vertex may follow, 1 or more; None for no limit. No more than
        `distances` were measured from.
    threshold : float
        Of the weights that are left, those below it are dropped, 0 to 1.

    Returns
    -------
    array, shape (n, j), float64
        Not negative, finite, rows sum to one.

    Raises
    ------
    ParameterError
        A parameter is out of its range, or the distances hold too few joints.

    References
    ----------
    Paper section 3.2, equation 1.
    """
    check_choice("falloff", falloff, FALLOFFS)
    alpha = check_number("alpha", alpha, 0, 1)
    threshold = check_number("threshold", threshold, 0, 1)
    if max_influences is not None:
        max_influences = check_integer("max_influences", max_influences, 1, MOST_INFLUENCES)
    known = distances.nearest_joints
    if known is not None and (max_influences is None or max_influences > known):
        raise ParameterError(
            f"max_influences is {max_influences}, but the distances were measured from the "
            f"{known} nearest joints of each vertex alone: measure them again with more "
            f"nearest_joints, or with None for all"
        )
    weights = paper_kernel(distances.joint, distances.graph.lattice.diagonal, alpha)
    return prune(weights, max_influences, threshold, _by_position(distances))


def _by_position(distances: BoneDistances) -> NDArray[np.intp]:
    """Order the joints by where they are, so that ties do not hang on how they are numbered."""
    positions = np.full((len(distances.joint), 3), np.inf)
    positions[distances.bones.joint] = distances.bones.start
    return np.lexsort(positions.T[::-1])
