"""The weights on the character."""

from __future__ import annotations

from viewers.description import Description
from viewers.weights_scene import weight_colors

from ..state import State
from .common import character
from .memo import Memo


def weights(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Weights; plain before anything is computed."""
    rig, binding = state.rig, state.binding
    if binding is None:
        return Description(character(state, memo))
    which = state.joint if state.weights_shown == "bone" else None
    colors, legend = memo(
        "weights", (binding, which), lambda: weight_colors(rig, binding.weights, which)
    )
    return Description(character(state, memo, **colors), legend=legend)
