"""The weights on the character."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell_viewers.description import Description, Legend
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.short_names import short_names
from cutcell_viewers.weights_scene import (
    bone_difference_colors,
    count_colors,
    difference_colors,
    dominant_colors,
    mask_colors,
    selections_colors,
    symmetry_colors,
    weight_colors,
)

from ..document.state import State
from .character import BODY_OPACITY_WITH_PATH, character
from .components import seen_apart
from .explanation import explained_paths
from .mask import chosen_layer, mask_strengths, masked
from .selection import isolated, outlined, selection_marks

DIFFERENCES = ("difference", "bone_difference")
"""Choices that need two weightings."""
FILES = "In the file"
"""Beginning of the legend of the file's own weights."""


def scene(state: State) -> Description:
    """Return the scene of the panel Weights; plain where there are no weights at all."""
    state = as_dragged(state)
    weights = weights_seen(state)
    if weights is None:
        return Description(character(state))
    style, legend, coloured = weights_look(state, weights)
    paths = explained_paths(state)
    if paths:
        style = {**style, "opacity": BODY_OPACITY_WITH_PATH}
    actors = character(state, bones_coloured=coloured, **style)
    if not paths:
        actors = seen_apart(state, actors)
    actors = isolated(state, actors)
    actors |= selection_marks(state, actors["body"])
    actors |= outlined(state, actors["body"], weights, weights_shown(state))
    return Description({**actors, **paths}, legend=legend)


def as_dragged(state: State) -> State:
    """Return a state with the joints as they are dragged."""
    if state.dragged is None:
        return state
    return state.changed(rig=state.dragged.rig, binding=state.dragged.binding)


def weights_look(
    state: State, weights: NDArray, name: str = "weights"
) -> tuple[dict[str, Any], Legend, bool]:
    """Return the colours of a body by weights, their legend, and whether bones have them, too.

    The memo keeps them under a name.
    """
    rig, colors = state.rig, weights_shown(state)
    which = state.joint if colors in ("bone", "bone_difference") else -1
    of_rig = rig.mesh, rig.weights, rig.skeleton.names
    how = state.weight_scale, state.weight_limit, state.asymmetry
    layer = chosen_layer(state) if colors == "mask" else None
    of_edits = layer, state.edits.selections if colors == "selections" else None
    inputs = (*of_rig, weights, state.rows, colors, which, state.truth, *how, *of_edits)
    style, legend = state.memo(name, inputs, lambda: coloring(state, colors, weights))
    coloured = colors in ("mix", "dominant")
    if coloured:
        bone, color = short_names(rig.skeleton.names)[state.joint], colors_of(rig)[state.joint]
        legend = replace(legend, swatches=((tuple(color.tolist()), bone),))
    if weights is rig.weights and colors not in DIFFERENCES:
        legend = replace(legend, title=f"{FILES}: {legend.title}")
    return style, legend, coloured


def painted_colors(state: State, vertices: NDArray, rows: NDArray) -> dict[str, NDArray]:
    """Return the colours of some vertices (v,) with other weights (v, j), as fields of `Actor`.

    These are "colors" or "scalars", or nothing if the colours do not depend on painted weights.
    """
    posed = state.panel == "pose" and (state.pose_colors != "weights" or state.heat)
    # Mirror images change with what is painted, masks and selections do not.
    other = weights_shown(state) in ("symmetry", "mask", "selections")
    if posed or other or weights_seen(state) is not state.rows:
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
        weight_scale=state.weight_scale,
        weight_limit=state.weight_limit,
    )
    style, _ = coloring(few, weights_shown(state), rows)
    return {name: style[name] for name in ("colors", "scalars") if name in style}


def file_rows(state: State) -> csr_array:
    """Return the file's weights (n, j) as a sparse matrix."""
    weights = state.rig.weights
    rows: csr_array = state.memo("file rows", (weights,), lambda: csr_array(weights))
    return rows


def weights_seen(state: State) -> Any:
    """Return the weights that are coloured; the file's own until others are computed.

    Those that are computed are sparse.
    """
    file_weights = state.rig.weights if state.weights_of == "file" else None
    return state.rows if file_weights is None else file_weights


def weights_shown(state: State) -> str:
    """Return the choice of colours, but no difference if there is only one weighting."""
    two = state.binding is not None and state.rig.weights is not None
    if state.weights_shown == "mask" and chosen_layer(state) is None:
        return "mix"
    if state.weights_shown == "selections" and not state.edits.selections:
        return "mix"
    if state.weights_shown == "symmetry" and state.asymmetry is None:
        return "mix"
    if state.weights_shown in DIFFERENCES and not two:
        return "mix" if state.weights_shown == "difference" else "bone"
    return state.weights_shown


def coloring(state: Any, colors: str, weights: NDArray) -> tuple[dict[str, Any], Legend]:
    """Return the fields of the body's `Actor` that colour it, and the legend.

    `state` needs no more than the choices of these colours, and may be of a few vertices.
    """
    rig = state.rig
    if colors == "difference":
        return difference_colors(rig, state.weights, rig.weights)
    if colors == "bone_difference":
        pair, who = (state.weights, rig.weights), ("ours", "the file")
        if state.truth != "file":
            pair, who = pair[::-1], who[::-1]
        return bone_difference_colors(rig, *pair, state.joint, who)
    if colors == "mask":
        layer, strengths = chosen_layer(state), mask_strengths(state)
        assert layer is not None
        assert strengths is not None
        return mask_colors(strengths, layer.title)
    if colors == "selections":
        sets = {name: masked(mask, rig.mesh) for name, mask in state.edits.selections.items()}
        return selections_colors(sets, len(rig.mesh.vertices))
    if colors == "symmetry":
        return symmetry_colors(state.asymmetry.values)
    if colors == "count":
        return count_colors(rig, weights)
    if colors == "dominant":
        return dominant_colors(rig, weights)
    joint = state.joint if colors == "bone" else None
    return weight_colors(rig, weights, joint, scale=state.weight_scale, limit=state.weight_limit)
