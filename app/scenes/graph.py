"""The graph inside the character."""

from __future__ import annotations

from dataclasses import replace

from viewers.description import Actor, Cut, Description
from viewers.graph_scene import graph_scene

from ..state import LAYERS, State
from .common import SEE_THROUGH, cells_of, character, cut_of, theme_of
from .memo import Memo

SLICE_CELLS = 3
"""How thick a thin slice of the interior is."""


def graph(state: State, memo: Memo) -> Description:
    """Return the scene of the panel Graph: the layers of the graph, at rest."""
    cut = cut_of(state)
    actors = character(state, memo, visible=state.body, opacity=body_opacity(state))
    return Description({**actors, **graph_layers(state, cut, memo)}, cut=cut)


def graph_layers(state: State, cut: Cut | None, memo: Memo) -> dict[str, Actor]:
    """Return the graph's actors."""
    if state.binding is None:
        return {}
    rig, lattice, theme = state.rig, state.binding.graph, theme_of(state)
    drawn = memo(
        "graph",
        (rig, lattice, theme.name),
        lambda: graph_scene(rig, lattice, theme=theme).actors,
    )
    slab = cells_of(state, SLICE_CELLS) if cut is not None and state.thin else 0.0
    result = {}
    for layer, name in LAYERS.items():
        if name in drawn:
            behind = slab if name == "interior edges" else 0.0
            result[name] = replace(drawn[name], visible=getattr(state, layer), slab=behind)
    return result


def body_opacity(state: State) -> float:
    """Return how opaque the body is: see-through where the interior would else be hidden."""
    looks_inside = state.interior_edges and state.cut_axis == "off"
    return SEE_THROUGH if looks_inside and state.binding is not None else 1.0
