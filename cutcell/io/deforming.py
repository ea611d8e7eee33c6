"""Which joints of a file deform: cutcell stored it, else weights say so, else names and places."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..rig import Skeleton, TriangleMesh
from ..rig.deform_joints import deform_joints
from ..rig.names import is_neutral
from ..runtime.display import listed
from .weights import normalised

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
) -> tuple[Skeleton, NDArray[np.float64] | None, list[str]]:
    """Find out which joints may carry weight, and say what a person may want to change.

    Also returns the weights without those of Blender's stand-in for vertices without weights.

    Shapes: weights (n, j), stored (j,); returns weights (n, j).
    """
    neutral = neutral_joints(skeleton)
    if not neutral.any():
        skeleton, warnings = _deforming(mesh, skeleton, weights, stored)
        return skeleton, weights, warnings
    about_neutral: list[str] = []
    if weights is not None and weights[:, neutral].any():
        about_neutral = [_neutral_warning(skeleton, neutral, weights)]
        weights = normalised(np.where(neutral, 0.0, weights))
    if stored is not None:
        stored = np.where(neutral, 0, stored)
    skeleton, warnings = _deforming(mesh, skeleton, weights, stored)
    return skeleton, weights, about_neutral + warnings


def neutral_joints(skeleton: Skeleton) -> NDArray[np.bool_]:
    """Return which joints are Blender's stand-in for vertices without weights, shape (j,)."""
    neutral = np.array([is_neutral(name) for name in skeleton.names], bool)
    return neutral & (not neutral.all())


def _deforming(
    mesh: TriangleMesh,
    skeleton: Skeleton,
    weights: NDArray[np.float64] | None,
    stored: NDArray[np.int8] | None,
) -> tuple[Skeleton, list[str]]:
    """Return the skeleton with the joints that deform, and warnings."""
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


def _neutral_warning(
    skeleton: Skeleton, neutral: NDArray[np.bool_], weights: NDArray[np.float64]
) -> str:
    count = int((weights[:, neutral] > 0).any(axis=1).sum())
    return (
        f"{count:,} of {len(weights):,} vertices had no weights in Blender, which gives such "
        f"vertices to {_names(skeleton, neutral)}: they count as without weight, and binding gives "
        "them new weights"
    )


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
        f"{_names(skeleton, weighted)} have weight in the file, but the file marks them as "
        "not deforming: new weights give them none"
    ]


def _names(skeleton: Skeleton, which: NDArray[np.bool_]) -> str:
    return listed([skeleton.names[j] for j in np.flatnonzero(which)])
