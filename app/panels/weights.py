"""Weights: how much each bone holds, and how it falls with distance."""

from typing import Any

import numpy as np
import panel_material_ui as pmui

from cutcell.method import FALLOFFS

from ..commands.session import Session
from ..state import State
from .brush import brush
from .components import parts_of_mesh
from .controls import caption, choice, column, follow, lead, section, select_box, slider, when
from .corrections import corrections
from .joints import joints

SHOWN = {
    "All bones": "mix",
    "Dominant bone": "dominant",
    "Selected bone": "bone",
    "Influences per vertex": "count",
}
DIFFERENCE = {
    "Difference from the file's": "difference",
    "Difference of the selected bone": "bone_difference",
}
FALLOFF_TITLES = {"rig": "Animation", "paper": "Paper"}


def weights(session: Session) -> pmui.Column:
    """Return the controls of the panel Weights."""
    state = session.state
    select = select_box("Colour by", SHOWN)

    def offered() -> tuple[dict[str, str], str]:
        has_weights = state.rig is not None and state.rig.weights is not None
        options = {**SHOWN, **(DIFFERENCE if has_weights else {})}
        return options, state.weights_shown if state.weights_shown in options.values() else "mix"

    follow(select, state, "weights_shown", offered, ["rig"])
    facts = caption(told(state))

    def tell() -> None:
        facts.object = told(state)

    # The colours go first.
    state.param.watch(lambda *events: session.tasks.after_a_pause(tell, "told"), ["binding", "rig"])
    return column(
        lead("How strongly each bone moves the skin."),
        section("", select, *_sides(state), facts, margin=(8, 20, 4, 20)),
        brush(session),
        joints(session),
        section("Falloff with distance", *_falloff(state)),
        parts_of_mesh(session),
        corrections(session),
    )


def _sides(state: State) -> list[Any]:
    """Return the choices between what was computed and what the file says."""
    names = {"Computed": "ours", "From file": "file"}
    whose = choice(
        state.param.weights_of,
        names,
        visible=when(
            lambda rig, shown: _has_own(rig) and shown not in DIFFERENCE.values(),
            state.param.rig,
            state.param.weights_shown,
        ),
    )
    signed = when(
        lambda rig, shown: _has_own(rig) and shown == "bone_difference",
        state.param.rig,
        state.param.weights_shown,
    )
    truth = {"The file is right": "file", "Ours are right": "ours"}
    return [whose, choice(state.param.truth, truth, visible=signed)]


def _has_own(rig: Any) -> bool:
    return rig is not None and rig.weights is not None


def _falloff(state: State) -> list[Any]:
    kernels = {FALLOFF_TITLES.get(name, name.capitalize()): name for name in FALLOFFS}
    alpha = slider(
        state.param.alpha,
        "Smoothness α",
        step=0.01,
        visible=when(lambda falloff: falloff == "paper", state.param.falloff),
    )
    return [
        *([choice(state.param.falloff, kernels)] if len(kernels) > 1 else []),
        alpha,
        slider(state.param.max_influences, "Max influences", whole=True),
        slider(state.param.threshold, "Ignore weights below", step=0.005, end=0.3),
    ]


def told(state: State) -> str:
    """Return what there is to say of the weights in a line."""
    if state.binding is None:
        return ""
    weights = state.binding.weights
    positive = np.flatnonzero(weights > 0)
    text = f"{len(positive) / max(len(weights), 1):.1f} influences per vertex"
    file_weights = state.rig.weights
    if file_weights is not None and file_weights.shape == weights.shape:
        # Of |a - b| = a + b - 2 min(a, b) the last is zero where ours is: nearly everywhere.
        both = np.minimum(weights.ravel()[positive], file_weights.ravel()[positive]).sum()
        difference = ((len(weights) + file_weights.sum()) / 2 - both) / max(len(weights), 1)
        text += f"; they differ from the file's by {difference:.0%}"
    return text + "."
