"""The weights on the character."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from cutcell_viewers.description import Description, Legend
from cutcell_viewers.palette import joint_colors
from cutcell_viewers.weights_scene import (
    count_colors,
    difference_colors,
    dominant_colors,
    weight_colors,
)

from ..state import State
from .common import character
from .memo import Memo


def weights(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Weights; plain before anything is computed."""
    if state.binding is None:
        return Description(character(state, memo))
    shown = weights_shown(state)
    which = state.joint if shown == "bone" else -1
    colors, legend = memo(
        "weights", (state.rig, state.weights, shown, which), lambda: coloring(state, shown)
    )
    coloured = shown in ("mix", "dominant")
    if coloured:
        name = state.rig.skeleton.names[state.joint]
        own = joint_colors(state.rig.skeleton.parents)[state.joint]
        legend = replace(legend, swatches=((tuple(own.tolist()), name),))
    return Description(character(state, memo, bones_coloured=coloured, **colors), legend=legend)


def weights_shown(state: State) -> str:
    """Return what is seen of the weights: there may be none to differ from."""
    if state.weights_shown == "difference" and state.rig.weights is None:
        return "mix"
    return state.weights_shown


def coloring(state: State, shown: str) -> tuple[dict[str, Any], Legend]:
    """Return the fields of the body's `Actor` that colour it, and how to read them."""
    rig, held = state.rig, state.weights
    if shown == "difference":
        return difference_colors(rig, held, rig.weights)
    if shown == "count":
        return count_colors(rig, held)
    if shown == "dominant":
        return dominant_colors(rig, held)
    return weight_colors(rig, held, state.joint if shown == "bone" else None)
