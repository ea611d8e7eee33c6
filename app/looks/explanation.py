"""Explanation of the chosen vertex's weights, for its card and as paths in the scene."""

from dataclasses import replace
from typing import Any

import numpy as np

from cutcell.binding import Explanation, JointShare
from cutcell.binding.absence import STEP_LABELS
from cutcell_viewers.character import to_scene
from cutcell_viewers.description import Actor
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.marks import path_tube

from ..document.state import State

MAX_JOINTS = 4
"""Number of joints that are explained besides the chosen one, the heaviest first."""


def explanation_of(state: State) -> Explanation | None:
    """Return the explanation of the chosen vertex, if it is on and computed."""
    return state.explanation if state.explain else None


def explanation_facts(state: State) -> dict[int, dict[str, Any]]:
    """Return the explanations on the card, by joint.

    Returns
    -------
    dict
        By joint: "distance" and "straight" in the file's units (None if the joint is not among
        the nearest), "path" (kind and length of each run of pieces of a kind), "factors" of the
        distance with their reasons, "effective", "steps" (name and weight), "rank" of the
        distance, "absence" (why it has no weight, or empty), and "chosen".
    """
    return {
        share.joint: {**_facts(share), "chosen": share.joint == state.joint}
        for share in explained(state)
    }


def explained(state: State) -> list[JointShare]:
    """Return the heaviest joints, and the chosen one."""
    explanation = explanation_of(state)
    shares = () if explanation is None else explanation.joints
    return [one for k, one in enumerate(shares) if k < MAX_JOINTS or one.joint == state.joint]


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
        "steps": [[STEP_LABELS.get(name, name), value] for name, value in share.steps.items()],
        "file": share.file_weight,
        "rank": share.rank,
        "absence": share.absence,
    }


def _finite(length: float) -> float | None:
    return length if np.isfinite(length) else None


def explained_paths(state: State) -> dict[str, Actor]:
    """Return the paths from the chosen vertex to the joints that are explained, as tubes."""
    explanation = explanation_of(state)
    if explanation is None:
        return {}
    inputs = explanation, state.joint
    tubes: dict[str, Actor] = state.memo("explained", inputs, lambda: _tubes(state))
    return tubes


def _tubes(state: State) -> dict[str, Actor]:
    rig, tubes = state.rig, {}
    colors = colors_of(rig)
    for share in explained(state):
        if share.path and (share.weight > 0 or share.joint == state.joint):
            points = np.array([share.path[0].start, *(piece.end for piece in share.path)])
            tube = path_tube(rig, to_scene(rig, points))
            tubes[f"path to {share.joint}"] = replace(tube, color=tuple(colors[share.joint]))
    return tubes
