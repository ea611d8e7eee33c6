"""Weights: how much each bone holds, and how it falls with distance."""

from typing import Any

import numpy as np
import panel_material_ui as pmui

from cutcell.method import FALLOFFS

from ..commands.session import Session
from ..state import State
from .brush import brush
from .components import parts_of_mesh
from .controls import (
    caption,
    choice,
    column,
    folded,
    follow,
    has_weights,
    intro,
    section,
    select_box,
    slider,
    when,
)
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
        options = {**SHOWN, **(DIFFERENCE if has_weights(state.rig) else {})}
        return options, state.weights_shown if state.weights_shown in options.values() else "mix"

    follow(select, state, "weights_shown", offered, ["rig"])
    facts = caption(summary(state))

    def update() -> None:
        facts.object = summary(state)

    # The colours go first.
    state.param.watch(
        lambda *events: session.tasks.after_a_pause(update, "told"), ["binding", "rig"]
    )
    return column(
        intro("How strongly each bone moves the skin."),
        section("", select, *_sides(state), facts, margin=(0, 20, 4, 20)),
        brush(session),
        joints(session),
        folded("Falloff", *_falloff(state)),
        parts_of_mesh(session),
        corrections(session),
    )


def _sides(state: State) -> list[Any]:
    """Return the choices between what was computed and what the file says."""
    names = {"Current": "ours", "Original": "file"}
    whose = choice(
        state.param.weights_of,
        names,
        visible=when(
            lambda rig, colors: has_weights(rig) and colors not in DIFFERENCE.values(),
            state.param.rig,
            state.param.weights_shown,
        ),
    )
    signed = when(
        lambda rig, colors: has_weights(rig) and colors == "bone_difference",
        state.param.rig,
        state.param.weights_shown,
    )
    truth = {"Reference: file": "file", "Reference: computed": "ours"}
    return [whose, choice(state.param.truth, truth, visible=signed)]


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
        choice(
            state.param.refine,
            {"Rules": "none", "Rules and learned": "learned"},
            visible=when(lambda falloff: falloff == "rig", state.param.falloff),
        ),
        slider(state.param.max_influences, "Max influences", whole=True),
        slider(state.param.threshold, "Ignore weights below", step=0.005, end=0.3),
    ]


def summary(state: State) -> str:
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
        text += f", {100 * difference:.0f}% different from the file"
    return text + "."
