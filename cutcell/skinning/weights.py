"""Skinning weights from bone distances (paper section 3.2)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import check_choice, check_integer, check_number
from ..errors import ParameterError
from ..geodesics import BoneDistances
from ..progress import Progress, share_of, silent
from ..threads import in_threads, parts, threads
from .kernel import paper_kernel, pruned_paper_kernel
from .prune import A_PART, prune
from .rig_falloff import NEAREST_JOINTS, TOWARDS, permitted, rig_kernel
from .skin import Skin

FALLOFFS = ("rig", "paper")
DEFAULT_LEAF = {"rig": "fit", "paper": "point"}
"""The bones that each falloff is made for; see `bone_distances`."""
MOST_INFLUENCES = 1024


def skinning_weights(
    distances: BoneDistances,
    *,
    falloff: str = "paper",
    alpha: float = 0.5,
    max_influences: int | None = 4,
    threshold: float = 0.0,
    allowed: NDArray[np.bool_] | None = None,
    skin: Skin | None = None,
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Turn distances into weights.

    Parameters
    ----------
    distances : BoneDistances
    falloff : {"paper", "rig"}
        "paper": equation 1 of the paper, a soft kernel of the distance alone. "rig": made to
        animate with, see docs/falloff.md; for distances with `leaf="fit"`.
    alpha : float
        Smoothness of the paper's falloff, 0 to 1.
    max_influences : int or None
        Joints a vertex may follow, 1 or more; None for no limit. `distances` must be those
        of enough joints, see `joints_needed`.
    threshold : float
        Of the weights that are left, those below it are dropped, 0 to 1.
    allowed : array, shape (n, j), bool, optional
        Which joints each vertex may follow; see `Rig.allowed`.
    skin : Skin, optional
        Of the distances' graph, if it is known already; "paper" does not ask for it.
    progress : callable
        See `cutcell.progress`; the stage is called "weights".

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
    falloff = check_choice("falloff", falloff, FALLOFFS)
    alpha = check_number("alpha", alpha, 0, 1)
    max_influences, threshold = check_pruning(max_influences, threshold)
    known, needed = distances.nearest_joints, joints_needed(falloff, max_influences)
    if known is not None and (needed is None or needed > known):
        raise ParameterError(
            f"max_influences is {max_influences}, but the distances were measured from the "
            f"{known} nearest joints of each vertex alone: measure them again with "
            f"nearest_joints={needed}{', for all' * (needed is None)}"
        )

    def tell(done: float) -> None:
        progress("weights", done)

    kept = max_influences, threshold, _by_position(distances)
    place, diagonal = distances.graph.vertex_node, distances.graph.lattice.diagonal
    if allowed is None:  # what is at one place gets the same
        if falloff == "paper":
            pruned = pruned_paper_kernel(distances.at_places, diagonal, alpha, *kept)
        else:
            spread = rig_kernel(distances, skin or Skin.of(distances.graph), share_of(tell, 0, 0.8))
            pruned = prune(spread, *kept, share_of(tell, 0.8, 0.9))
        weights = np.empty((len(place), pruned.shape[1]))
        in_threads(
            lambda part: pruned.take(place[part], axis=0, out=weights[part], mode="clip"),
            parts(len(place), threads() + weights.size // A_PART),
            share_of(tell, 0.9, 1),
        )
        return weights
    if falloff == "paper":
        weights = paper_kernel(distances.joint, diagonal, alpha)
    else:
        weights = rig_kernel(distances, skin or Skin.of(distances.graph), tell)[place]
    return prune(permitted(weights, distances.joint, allowed), *kept)


def keep_strongest(
    distances: BoneDistances,
    weights: NDArray[np.float64],
    max_influences: int | None = 4,
    threshold: float = 0.0,
) -> NDArray[np.float64]:
    """Keep the largest weights of each vertex: the last step of `skinning_weights`.

    Weights that were kept generously once can be pruned in many ways after.

    Parameters
    ----------
    distances : BoneDistances
        What the weights were made from.
    weights : array, shape (n, j)
        Rows sum to one.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    array, shape (n, j), float64
        Rows sum to one.

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    max_influences, threshold = check_pruning(max_influences, threshold)
    return prune(weights, max_influences, threshold, _by_position(distances))


def check_pruning(max_influences: Any, threshold: Any) -> tuple[int | None, float]:
    """Return which weights are kept, as numbers.

    Raises
    ------
    ParameterError
        One is out of its range.
    """
    threshold = check_number("threshold", threshold, 0, 1)
    if max_influences is not None:
        max_influences = check_integer("max_influences", max_influences, 1, MOST_INFLUENCES)
    return max_influences, threshold


def joints_needed(falloff: str, max_influences: int | None) -> int | None:
    """Return from how many nearest joints of each vertex a falloff needs distances."""
    if falloff == "paper" or max_influences is None:
        return max_influences
    return NEAREST_JOINTS


def reach_needed(falloff: str) -> float:
    """Return how many times as far as the nearest a joint may be and still get some weight."""
    return 1 / TOWARDS if falloff == "rig" else np.inf


def _by_position(distances: BoneDistances) -> NDArray[np.intp]:
    """Order the joints by where they are, so that ties do not hang on how they are numbered."""
    positions = np.full((len(distances.at_places), 3), np.inf)
    positions[distances.bones.joint] = distances.bones.start
    return np.lexsort(positions.T[::-1])
