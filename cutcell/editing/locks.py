"""Lock joints: keep an artist's weights of some joints and fill in the rest."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError, WeightsError
from ..rig import Rig, Skeleton
from ..rig.checks import LONG, check_integer, one_line, shown
from ..rig.names import folded


def lock_joints(
    rig: Rig,
    weights: NDArray[np.float64],
    locked: Sequence[int | str],
    max_influences: int | None = None,
) -> NDArray[np.float64]:
    """Put back the rig's own weights of some joints; the others share what these leave.

    If no other joint has weight, the rig's own weights of the others are restored, too. A vertex
    without weights in the file keeps those of the joints that are not locked, if it has any.

    Shapes: weights (n, j); returns (n, j).
    """
    is_locked = locked_joints(rig, locked)
    if not is_locked.any() or rig.weights is None:
        return weights
    locked_weights = np.where(is_locked, rig.weights, 0.0)
    free = np.where(is_locked, 0.0, weights)
    if max_influences is not None:
        free = _largest(free, max_influences - (locked_weights > 0).sum(axis=1))
    others = np.where(is_locked, 0.0, rig.weights)
    share = free.sum(axis=1, keepdims=True)
    has_weight = rig.weights.any(axis=1, keepdims=True)
    rest = np.where(has_weight, others.sum(axis=1, keepdims=True), 1.0)
    result = locked_weights + np.divide(free * rest, share, out=others, where=share > 0)
    return np.where(has_weight | (share > 0), result, weights)


def locked_joints(rig: Rig, locked: Sequence[int | str]) -> NDArray[np.bool_]:
    """Return whether each joint is locked, shape (j,)."""
    if isinstance(locked, str) or not isinstance(locked, Sequence | np.ndarray):
        raise ParameterError(
            f"locked must be a list of joints, by index or by name, not {shown(locked)}"
        )
    is_locked = np.zeros(len(rig.skeleton.names), bool)
    for joint in locked:
        is_locked[joint_index(rig.skeleton, joint)] = True
    if is_locked.any() and rig.weights is None:
        raise WeightsError(
            f"{rig.name} has no weights of its own, so no joint of it can be locked; "
            "leave out the locked joints"
        )
    return is_locked


def joint_index(skeleton: Skeleton, joint: int | str) -> int:
    """Return the index of a joint that is given by its index or its name."""
    names = list(skeleton.names)
    if isinstance(joint, str):
        if joint in names:
            return names.index(joint)
        comparable = dict(zip(map(folded, reversed(names)), reversed(names), strict=True))
        close = get_close_matches(folded(joint), comparable, n=3, cutoff=0.4)
        close = [comparable[name] for name in close] or names[:3]
        query = one_line(joint)[:LONG]
        if not names:
            raise ParameterError(f'there is no joint "{query}": the mesh has no skeleton')
        raise ParameterError(
            f'there is no joint "{query}" among the {len(names)} of the skeleton; there is '
            + ", ".join(f'"{name}"' for name in close)
        )
    return check_integer("joint", joint, 0, len(names) - 1, "or the name of one")


def _largest(weights: NDArray[np.float64], count: NDArray[np.intp]) -> NDArray[np.float64]:
    """Keep the `count` largest weights of each row; ties go to the lower index."""
    order = np.argsort(-weights, axis=1, kind="stable")
    rank = np.empty_like(order)
    np.put_along_axis(rank, order, np.arange(weights.shape[1])[None, :], axis=1)
    return np.where(rank < count[:, None], weights, 0.0)
