"""How the chosen vertex comes to its weights: for the card, and the paths in the scene."""

from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.editing import Explanation, JointShare
from cutcell.editing.explain import STEPS
from cutcell_viewers.character import to_scene
from cutcell_viewers.description import Actor
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.marks import path_tube

from ..state import State
from .memo import Memo

MAX_JOINTS = 4
"""How many joints are explained, the heaviest first."""


def explanation_of(state: State) -> Explanation | None:
    """Return what explains the chosen vertex, if that is asked for and there."""
    if not state.explain or state.explanation is None:
        return None
    binding, explanation = state.explanation
    current = binding is state.binding and explanation.vertex == state.vertex
    return explanation if current else None


def explanation_facts(state: State) -> dict[int, dict[str, Any]]:
    """Return what the card tells of each joint that is explained.

    Returns
    -------
    dict
        By joint: "distance" and "straight" in the file's units (None where the joint is not among
        the nearest), "path" (kind and length of each run of pieces of a kind), "factors" (what the
        distance is multiplied by, and why), "effective" and "steps" (name and weight).
    """
    explanation = explanation_of(state)
    shares = () if explanation is None else explanation.joints[:MAX_JOINTS]
    return {share.joint: _facts(share) for share in shares}


def _facts(share: JointShare) -> dict[str, Any]:
    runs: list[list[Any]] = []
    for piece in share.path:
        if runs and runs[-1][0] == piece.kind:
            runs[-1][1] += piece.length
        else:
            runs.append([piece.kind, piece.length])
    return {
        "distance": _finite(share.distance),
        "straight": _finite(share.straight),
        "path": runs,
        "factors": [[name, value] for name, value in share.factors.items() if value != 1],
        "effective": _finite(share.effective),
        "steps": [[STEPS[name], value] for name, value in share.steps.items()],
        "file": share.file_weight,
    }


def _finite(length: float) -> float | None:
    return length if np.isfinite(length) else None


def explained_paths(state: State, memo: Memo) -> dict[str, Actor]:
    """Return the paths from the chosen vertex to the joints that are explained, as tubes."""
    explanation = explanation_of(state)
    return (
        {}
        if explanation is None
        else memo("explained", (explanation,), lambda: _tubes(state, explanation))
    )


def _tubes(state: State, explanation: Explanation) -> dict[str, Actor]:
    rig, tubes = state.rig, {}
    colors = colors_of(rig)
    for share in explanation.joints[:MAX_JOINTS]:
        if share.path and share.weight > 0:
            points = np.array([share.path[0].start, *(piece.end for piece in share.path)])
            tube = path_tube(rig, to_scene(rig, points))
            tubes[f"path to {share.joint}"] = replace(tube, color=tuple(colors[share.joint]))
    return tubes
