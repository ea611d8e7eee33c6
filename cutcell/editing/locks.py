"""Lock joints: keep an artist's weights of some joints and fill in the rest."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from ..checks import MAX_SHOWN, check_integer, one_line, shown
from ..errors import ParameterError, WeightsError
from ..rig import Rig, Skeleton
from ..rig.names import folded


def lock_joints(
    rig: Rig,
    weights: NDArray[np.float64],
    locked: Sequence[int | str],
    max_influences: int | None = None,
    which: NDArray[np.intp] | None = None,
) -> NDArray[np.float64]:
    """Put back the rig's own weights of some joints; the others share what these leave.

    If no other joint has weight, the rig's own weights of the others are restored, too. A vertex
    without weights in the file keeps those of the joints that are not locked, if it has any.

    Shapes: weights (n, j), which (k,) or None for all vertices; returns (k, j).
    """
    is_locked, stored = locked_joints(rig, locked), rig.weights
    if which is not None:
        weights, stored = weights[which], None if stored is None else stored[which]
    if not is_locked.any() or stored is None:
        return weights
    weights = weights.copy() if which is None else weights
    columns = np.flatnonzero(is_locked)
    before = weights[:, columns]
    weights[:, columns] = 0.0
    if max_influences is not None:
        _keep_largest(weights, max_influences - (stored[:, columns] > 0).sum(axis=1))
    others = stored.copy()
    others[:, columns] = 0.0
    share, has_weight = weights.sum(axis=1, keepdims=True), stored.any(axis=1, keepdims=True)
    np.divide(weights, share, out=weights, where=share > 0)  # first: they may be tiny
    weights *= np.where(has_weight, others.sum(axis=1, keepdims=True), 1.0)
    is_empty = share[:, 0] <= 0
    weights[is_empty] = others[is_empty]
    weights[:, columns] = np.where(has_weight | (share > 0), stored[:, columns], before)
    return weights


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
        query = one_line(joint)[:MAX_SHOWN]
        if not names:
            raise ParameterError(f'there is no joint "{query}": the mesh has no skeleton')
        raise ParameterError(
            f'there is no joint "{query}" among the {len(names)} of the skeleton; there is '
            + ", ".join(f'"{name}"' for name in close)
        )
    return check_integer("joint", joint, 0, len(names) - 1, "or the name of one")


def _keep_largest(weights: NDArray[np.float64], count: NDArray[np.intp]) -> None:
    """Keep, in place, the `count` largest weights of each row; ties go to the lower index."""
    row, column = np.divmod(np.flatnonzero(weights != 0), weights.shape[1])
    is_many = np.bincount(row, minlength=len(weights)) > count
    row, column = row[is_many[row]], column[is_many[row]]
    order = np.lexsort((-weights[row, column], row))
    row, column = row[order], column[order]
    is_over = np.arange(len(row)) - np.searchsorted(row, row) >= count[row]
    weights[row[is_over], column[is_over]] = 0.0
