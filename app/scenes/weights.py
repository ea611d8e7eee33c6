"""The weights on the character."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell_viewers.description import Actor, Description, Legend
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.marks import vertex_dots
from cutcell_viewers.short_names import short_names
from cutcell_viewers.weights_scene import (
    bone_difference_colors,
    count_colors,
    difference_colors,
    dominant_colors,
    weight_colors,
)

from ..state import State
from ..state.brush import selected
from .common import character
from .components import seen_apart
from .explain import explained_paths
from .memo import Memo

DIFFERENCES = ("difference", "bone_difference")
"""Words that distinguish two sides."""
BODY_OPACITY_WITH_PATHS = 0.42
"""How opaque the body is while paths inside it are to be seen."""
FILES = "In the file"
"""Beginning of the legend of the file's own weights."""


def weights(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Weights; plain where there are no weights at all."""
    state = as_dragged(state)
    weights = weights_seen(state)
    if weights is None:
        return Description(character(state, memo))
    style, legend, coloured = weights_look(state, memo, weights)
    paths = explained_paths(state, memo)
    if paths:
        style = {**style, "opacity": BODY_OPACITY_WITH_PATHS}
    actors = character(state, memo, bones_coloured=coloured, **style)
    if not paths:
        actors = seen_apart(state, memo, actors)
    actors |= selection_marks(state, memo, actors["body"])
    return Description({**actors, **paths}, legend=legend)


def selection_marks(state: State, memo: Memo, body: Actor) -> dict[str, Actor]:
    """Return dots on what the brush is limited to."""
    chosen = selected(state) if state.brush else None
    if chosen is None:
        return {}
    inputs = body.points, body.normals, body.skin, chosen
    dots = memo("selection", inputs, lambda: vertex_dots(body, np.flatnonzero(chosen)))
    return {"selection": dots}


def as_dragged(state: Any) -> Any:
    """Return a state as it is seen while joints are dragged."""
    if state.dragged is None:
        return state
    snapshot = state.snapshot() if isinstance(state, State) else SimpleNamespace(**vars(state))
    snapshot.rig, snapshot.binding = state.dragged.rig, state.dragged.binding
    snapshot.weights = snapshot.binding.weights
    return snapshot


def weights_look(
    state: State, memo: Memo, weights: NDArray, name: str = "weights"
) -> tuple[dict[str, Any], Legend, bool]:
    """Return how a body is coloured by weights, how to read it, and whether bones are, too.

    Parameters
    ----------
    state : State
    memo : Memo
    held : array, shape (n, j)
    name : str
        What the memo keeps it under.
    """
    colors = weights_shown(state)
    which = state.joint if colors in ("bone", "bone_difference") else -1
    style, legend = memo(
        name,
        (
            state.rig.mesh,
            state.rig.weights,
            state.rig.skeleton.names,
            weights,
            state.weights,
            colors,
            which,
            state.truth,
        ),
        lambda: coloring(state, colors, weights),
    )
    coloured = colors in ("mix", "dominant")
    if coloured:
        bone = short_names(state.rig.skeleton.names)[state.joint]
        color = colors_of(state.rig)[state.joint]
        legend = replace(legend, swatches=((tuple(color.tolist()), bone),))
    if weights is state.rig.weights and colors not in DIFFERENCES:
        legend = replace(legend, title=f"{FILES}: {legend.title}")
    return style, legend, coloured


def painted_colors(state: State, vertices: NDArray, rows: NDArray) -> dict[str, NDArray]:
    """Return the colours of some vertices with other weights, as the body's `Actor` has them.

    Parameters
    ----------
    state : State
        With a binding.
    vertices : array, shape (v,), int
    rows : array, shape (v, j)

    Returns
    -------
    dict
        "colors", shape (v, 3), or "scalars", shape (v,); nothing where colours tell of no weights
        that are painted.
    """
    posed = state.panel == "pose" and (state.pose_colors != "weights" or state.heat)
    if posed or weights_seen(state) is not state.weights:
        return {}
    file_weights = state.rig.weights
    few = SimpleNamespace(
        rig=SimpleNamespace(
            skeleton=state.rig.skeleton,
            weights=None if file_weights is None else file_weights[vertices],
            colors=colors_of(state.rig),
        ),
        weights=rows,
        joint=state.joint,
        truth=state.truth,
    )
    style, _ = coloring(few, weights_shown(state), rows)
    return {name: style[name] for name in ("colors", "scalars") if name in style}


def weights_seen(state: State) -> Any:
    """Return the weights that colours tell: the file's own also until others are computed."""
    file_weights = state.rig.weights
    return (
        file_weights if state.weights_of == "file" and file_weights is not None else state.weights
    )


def weights_shown(state: State) -> str:
    """Return what is seen of the weights: there may be no two sides to tell apart."""
    two = state.binding is not None and state.rig.weights is not None
    if state.weights_shown in DIFFERENCES and not two:
        return "mix" if state.weights_shown == "difference" else "bone"
    return state.weights_shown


def coloring(state: Any, colors: str, weights: NDArray) -> tuple[dict[str, Any], Legend]:
    """Return the fields of the body's `Actor` that colour it, and how to read them."""
    rig = state.rig
    if colors == "difference":
        return difference_colors(rig, state.weights, rig.weights)
    if colors == "bone_difference":
        computed, original = state.weights, rig.weights
        pair = (computed, original) if state.truth == "file" else (original, computed)
        who = ("ours", "the file") if state.truth == "file" else ("the file", "ours")
        return bone_difference_colors(rig, *pair, state.joint, who)
    if colors == "count":
        return count_colors(rig, weights)
    if colors == "dominant":
        return dominant_colors(rig, weights)
    return weight_colors(rig, weights, state.joint if colors == "bone" else None)
