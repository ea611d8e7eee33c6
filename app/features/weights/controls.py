"""Weights: how much each bone holds, and how it falls with distance."""

from typing import Any

import numpy as np

from ...document.method import WEIGHTS
from ...document.state import State
from ...editing.brush.controls import BRUSH
from ...editing.correct.component_controls import COMPONENTS
from ...editing.correct.controls import EDITS
from ...editing.correct.joint_controls import JOINTS
from ...editing.layers.controls import LAYERS
from ...editing.select.bones import BONES
from ...editing.select.controls import SELECTION, WEIGHT_SCALE
from ...editing.symmetry.controls import PAIRS, SYMMETRY
from ...editing.transfer.controls import TRANSFER
from ...looks.weights import file_rows
from ...widgets import controls as ui

SHOWN = {
    "All bones": "mix",
    "Dominant bone": "dominant",
    "Selected bone": "bone",
    "Influences per vertex": "count",
    "Symmetry": "symmetry",
    "Mask of the layer": "mask",
}
SELECTIONS = {"Saved selections": "selections"}
DIFFERENCE = {
    "Difference from the file's": "difference",
    "Difference of the selected bone": "bone_difference",
}


def _colours(state: State) -> dict[str, Any]:
    """Return the choices of colours, and the chosen one."""
    options = {
        **SHOWN,
        **(SELECTIONS if state.edits.selections else {}),
        **(DIFFERENCE if ui.has_weights(state) else {}),
    }
    field = state.weights_shown
    return {"options": options, "value": field if field in options.values() else "mix"}


def _is_difference(state: State) -> bool:
    return state.weights_shown in DIFFERENCE.values()


def _is_signed(state: State) -> bool:
    return bool(state.weights_shown == "bone_difference")


def summary(state: State) -> str:
    """Summarize the weights in a line."""
    if state.binding is None:
        return ""
    rows = state.binding.rows
    vertices = max(rows.shape[0], 1)
    text = f"{np.count_nonzero(rows.data) / vertices:.1f} influences per vertex"
    file_weights = state.rig.weights
    if file_weights is not None and file_weights.shape == rows.shape:
        difference = abs(rows - file_rows(state)).sum() / 2 / vertices
        text += f", {100 * difference:.0f}% different from the file"
    return text + "."


CONTROLS = ui.column(
    ui.intro("How strongly each bone moves the skin."),
    ui.section(
        "",
        ui.select("weights_shown", "Colour by", shows=_colours),
        ui.choice("weights_of", visible=lambda s: ui.has_weights(s) and not _is_difference(s)),
        WEIGHT_SCALE,
        ui.choice("truth", visible=lambda s: ui.has_weights(s) and _is_signed(s)),
        SYMMETRY,
        ui.caption(summary, late=("binding", "rig")),
        top=0,
    ),
    BRUSH,
    SELECTION,
    LAYERS,
    BONES,
    JOINTS,
    PAIRS,
    ui.folded(
        "Falloff",
        ui.choice("falloff"),
        ui.option("alpha", visible=lambda s: s.falloff == "paper"),
        [ui.option(name) for name in WEIGHTS if name not in ("falloff", "alpha")],
    ),
    COMPONENTS,
    TRANSFER,
    EDITS,
)
