"""Which joints of a file may carry weight: its weights say so, else their names and places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..deform import deform_joints
from ..rig import Skeleton, TriangleMesh

STRAY = 1e-3
"""Part of all weight: a control that carries less was given it by mistake."""
MOST_NAMES = 6
"""Named in a warning."""


def with_deform(
    mesh: TriangleMesh, skeleton: Skeleton, weights: NDArray[np.float64] | None
) -> tuple[Skeleton, list[str]]:
    """Find out which joints may carry weight, and say what a person may want to change.

    Parameters
    ----------
    mesh : TriangleMesh
    skeleton : Skeleton
        Its `deform` is replaced.
    weights : array, shape (n, j), or None
        What the file has.

    Returns
    -------
    skeleton : Skeleton
    warnings : list of str
    """
    if not len(skeleton.joints):
        return skeleton, []
    total = 0.0 if weights is None else float(weights.sum())
    if weights is None or total == 0:
        deform = deform_joints(mesh, skeleton).deform
        return replace(skeleton, deform=deform), _told(skeleton, ~deform)
    share = weights.sum(axis=0) / total
    carries = share > 0
    stray = carries & (share < STRAY)
    if stray.any():
        stray &= ~deform_joints(mesh, skeleton).deform
    return replace(skeleton, deform=carries & ~stray), _told_stray(skeleton, stray)


def _told(skeleton: Skeleton, out: NDArray[np.bool_]) -> list[str]:
    if not out.any():
        return []
    return [
        f"{out.sum()} of {len(out)} joints are taken for controls, end markers or roots and get "
        f"no weight: {_names(skeleton, out)}"
    ]


def _told_stray(skeleton: Skeleton, stray: NDArray[np.bool_]) -> list[str]:
    if not stray.any():
        return []
    return [
        f"the file's weights give under {STRAY:.1%} to {_names(skeleton, stray)}: taken for "
        "controls, which get no weight"
    ]


def _names(skeleton: Skeleton, which: NDArray[np.bool_]) -> str:
    names = [skeleton.names[j] for j in np.flatnonzero(which)]
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more
