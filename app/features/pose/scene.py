"""The character in a pose or a motion, by the computed weights and by those of the file."""

from dataclasses import replace
from typing import Any

import numpy as np

from cutcell_viewers.character import body
from cutcell_viewers.description import Actor, Apart, Description, Legend
from cutcell_viewers.error_scene import (
    error_legend,
    error_limits,
    error_look,
    gap_between,
    millimetres,
)
from cutcell_viewers.materials import Textures
from cutcell_viewers.palette import GHOST
from cutcell_viewers.skin import Gap, Skin

from ...document.state import State
from ...looks.character import character
from ...looks.pose import pose_of
from ...looks.selection import isolated, selection_marks
from ...looks.weights import weights_look, weights_seen

GHOST_OPACITY = 0.38
VIEWS = ("cutcell", "Weights from the file")


def scene(state: State) -> Description:
    """Return the scene of the panel Pose."""
    placed = pose_of(state)
    textures = textures_of(state)
    style, legend, coloured = _colours(state, weights_seen(state), "weights")
    if state.heat and has_rival(state):
        style, legend = _error_colours(state, error_limits_of(state, placed))
        coloured = False
    actors = character(state, bones_coloured=coloured, **style)
    actors = isolated(state, actors)
    actors |= selection_marks(state, actors["body"])
    if textures is not None:
        actors |= _attachments_in_materials(actors, textures)
    description = Description(
        actors, pose=placed, legend=legend, images=None if textures is None else textures.images
    )
    if state.rival == "alone" or not has_rival(state):
        return description
    reference = rival_of(state)
    if state.rival == "ghost":
        reference = replace(reference, color=GHOST, opacity=GHOST_OPACITY, behind=True)
        return replace(description, actors={**actors, "rival": reference})
    actors["body"] = replace(actors["body"], view=0)
    file_style = {} if state.heat else _colours(state, state.rig.weights, "file weights")[0]
    reference = replace(reference, view=1, **file_style)
    return replace(description, actors={**actors, "rival": reference}, views=VIEWS)


def _error_colours(state: State, limits: tuple[float, float]) -> tuple[dict[str, Any], Legend]:
    rig, count = state.rig, len(state.rig.mesh.vertices)
    skin = state.memo(
        "apart", (rig,), lambda: Apart(Skin.of_weights(rig.weights), millimetres(rig))
    )
    style = state.memo("error look", (rig, limits[1]), lambda: error_look(count, skin, limits))
    return style, error_legend(limits)


def textures_of(state: State) -> Textures | None:
    """Return the materials of the character's file, if they are shown."""
    is_error = state.heat and has_rival(state)
    return None if is_error or state.pose_colors != "materials" else state.materials


def _attachments_in_materials(actors: dict[str, Actor], textures: Textures) -> dict[str, Actor]:
    colors = {f"attachment {i}": one for i, one in enumerate(textures.attachments)}
    return {name: replace(actors[name], materials=one) for name, one in colors.items()}


def _colours(state: State, weights: Any, name: str) -> tuple[dict[str, Any], Legend | None, bool]:
    """Return the colours of a moving body by its materials, once these are read, or by weights."""
    textures = textures_of(state)
    if textures is not None:
        return {"materials": textures.body}, None, False
    if state.pose_colors == "plain" or weights is None:
        return {}, None, False
    return weights_look(state, weights, name)


def has_rival(state: State) -> bool:
    """Return whether there are two weightings: the computed one and that of the file."""
    return state.binding is not None and state.rig.weights is not None


def rival_of(state: State) -> Actor:
    """Return the body as the file's own weights move it."""
    return state.memo("rival", (state.rig,), lambda: body(state.rig, state.rig.weights))


def gap_of(state: State) -> Gap:
    """Return the function of the distance between the two weightings in a pose."""
    rig, weights, blending = state.rig, state.binding.weights, state.blending
    inputs = (rig, state.binding, blending)
    return state.memo("gap", inputs, lambda: gap_between(rig, weights, rig.weights, blending))


def error_of(state: State) -> tuple[float, float] | None:
    """Return the root mean square and greatest error in mm of the pose or motion, if known."""
    if not has_rival(state):
        return None
    if state.moving:
        error = state.motion_error
        return error and error[:2]
    placed = pose_of(state)
    if placed is None:
        return (0.0, 0.0)
    lengths = lengths_of(state, placed)
    return float(np.sqrt(np.square(lengths).mean())), float(lengths.max())


def lengths_of(state: State, placed: np.ndarray) -> np.ndarray:
    """Return the error of each vertex in the pose of the sliders, in mm."""
    inputs = (state.binding, state.turns, state.blending)
    return state.memo("error", inputs, lambda: gap_of(state).lengths(placed))


def error_limits_of(state: State, placed: np.ndarray | None) -> tuple[float, float]:
    """Return the range of the error's colours, with round numbers."""
    if state.moving:
        error = state.motion_error
        return error_limits([0.0 if error is None else error[2]])
    return error_limits([0.0] if placed is None else lengths_of(state, placed))
