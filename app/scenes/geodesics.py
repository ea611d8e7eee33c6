"""The distance from the chosen bone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from viewers.description import Description
from viewers.distance_scene import distance_colors
from viewers.graph_scene import graph_scene

from ..state import State
from .common import cells_of, character, cut_of, theme_of
from .graph import SLICE_CELLS
from .memo import Memo


def geodesics(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Geodesics: a bone's field, on the surface and inside."""
    cut = cut_of(state)
    if not has_field(state):
        return Description(character(state, memo), cut=cut)
    rig, binding, joint = state.rig, state.binding, state.joint
    colors, legend = memo(
        "distance",
        (binding, joint),
        lambda: distance_colors(rig, binding.distances.on_mesh(joint), joint),
    )
    actors = character(state, memo, **colors)
    field, theme = field_of(state), theme_of(state)
    if cut is not None and field is not None:
        inside = memo(
            "inside",
            (rig, binding, field, theme.name),
            lambda: graph_scene(rig, binding.graph, field=field, theme=theme).actors,
        )["interior edges"]
        actors["interior edges"] = replace(inside, slab=cells_of(state, SLICE_CELLS))
    return Description(actors, cut=cut, legend=legend)


def has_field(state: State) -> bool:
    """Whether the chosen bone has distances: it was bound, and may carry weight."""
    return state.binding is not None and bool(state.rig.skeleton.deform[state.joint])


def wants_field(state: State) -> bool:
    """Whether the distance is to be known at every node of the graph."""
    return state.panel == "geodesics" and has_field(state) and state.cut_axis != "off"


def field_of(state: State) -> Any:
    """Return the distance at every graph node, shape (N,), if it is there."""
    if state.field is None:
        return None
    binding, joint, field = state.field
    return field if binding is state.binding and joint == state.joint else None
