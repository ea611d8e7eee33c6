"""Which joints of a file deform: cutcell stored it, else weights say so, else names and places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..rig import Skeleton, TriangleMesh
from ..rig.deform_joints import deform_joints
from ..runtime.display import listed

KEY = "cutcell_deform"
"""Under which a saved file stores for each joint whether it deforms: a joint that got no weight
still does."""
STRAY = 1e-3
"""Part of all weight: a control that carries less was given it by mistake."""


def with_deform(
    mesh: TriangleMesh,
    skeleton: Skeleton,
    weights: NDArray[np.float64] | None,
    stored: NDArray[np.int8] | None = None,
) -> tuple[Skeleton, list[str]]:
    """Find out which joints may carry weight, and say what a person may want to change.

    Shapes: weights (n, j), stored (j,).
    """
    if not len(skeleton.joints):
        return skeleton, []
    if stored is None or not (stored == 1).any():
        return _inferred(mesh, skeleton, weights)
    deform = stored == 1
    warnings: list[str] = []
    if (stored < 0).any():  # such as a skin that another program added
        inferred, warnings = _inferred(mesh, skeleton, weights)
        deform = np.where(stored < 0, inferred.deform, deform)
    if weights is not None:
        warnings += _weighted_warnings(skeleton, (stored == 0) & (weights > 0).any(axis=0))
    return replace(skeleton, deform=deform), warnings


def _inferred(
    mesh: TriangleMesh, skeleton: Skeleton, weights: NDArray[np.float64] | None
) -> tuple[Skeleton, list[str]]:
    total = 0.0 if weights is None else float(weights.sum())
    if weights is None or total == 0:
        deform = deform_joints(mesh, skeleton).deform
        return replace(skeleton, deform=deform), _control_warnings(skeleton, ~deform)
    share = weights.sum(axis=0) / total
    carries = share > 0
    stray = carries & (share < STRAY)
    if stray.any():
        stray &= ~deform_joints(mesh, skeleton).deform
    return replace(skeleton, deform=carries & ~stray), _stray_warnings(skeleton, stray)


def _control_warnings(skeleton: Skeleton, out: NDArray[np.bool_]) -> list[str]:
    if not out.any():
        return []
    return [
        f"{out.sum()} of {len(out)} joints are taken for controls, end markers or roots and get "
        f"no weight: {_names(skeleton, out)}"
    ]


def _stray_warnings(skeleton: Skeleton, stray: NDArray[np.bool_]) -> list[str]:
    if not stray.any():
        return []
    return [
        f"the file's weights give under {STRAY:.1%} to {_names(skeleton, stray)}: taken for "
        "controls, which get no weight"
    ]


def _weighted_warnings(skeleton: Skeleton, weighted: NDArray[np.bool_]) -> list[str]:
    if not weighted.any():
        return []
    return [
        f"{_names(skeleton, weighted)} have weight in the file, but by what it stores do not "
        "deform: new weights give them none"
    ]


def _names(skeleton: Skeleton, which: NDArray[np.bool_]) -> str:
    return listed([skeleton.names[j] for j in np.flatnonzero(which)])
