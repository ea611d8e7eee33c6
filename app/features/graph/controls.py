"""The graph: how it is built, which of its layers are seen, and where it is cut."""

from typing import Any

import numpy as np
import panel_material_ui as pmui

from cutcell.graph import INTERIOR, MESH, SURFACE
from cutcell_viewers.palette import to_hex

from ...document.framing import theme_of
from ...document.method import GRAPH, READABLE
from ...document.state import State
from ...editing.binding.recovery import CHAIN
from ...looks.controls import CUTTING
from ...widgets import controls as ui
from .choices import LAYERS, Choices

KINDS = {"mesh_edges": MESH, "interior_edges": INTERIOR, "surface_edges": SURFACE}
PLACED = ("resolution", "winding_threshold", "orient", "connectivity")
"""Options whose controls have a place of their own; all others follow them."""
SEARCHED = (
    "Interior edges only carry the search: paths run straight along lines of sight. Click the "
    "body to see them."
)
"""Description of interior edges where paths need not follow them."""
NUMBER = {
    "fontSize": "12px",
    "color": "text.secondary",
    "fontVariantNumeric": "tabular-nums",
    "textAlign": "right",
}


def count(state: State, layer: str) -> str:
    """Return how many faces or edges a layer has, as text."""
    if layer == "body":
        return "" if state.rig is None else f"{len(state.rig.mesh.faces):,} faces"
    if state.shown_graph is None:
        return ""
    return f"{np.count_nonzero(state.shown_graph.edge_kind == KINDS[layer]):,}"


def _layer(layer: str) -> ui.Control:
    """Return the switch of a layer, and how much it has."""
    colours = {"sx": lambda state: _switch_colors(state, layer)} if layer in KINDS else {}
    return ui.row(
        ui.switch(layer, margin=(1, 0), **colours),
        ui.column(),
        ui.text_line(lambda state: count(state, layer), sx=NUMBER, margin=(3, 0), width=110),
        # A slice shows rays instead of edges.
        visible=lambda state: layer == "body" or not state.slicing,
    )


def _switch_colors(state: State, layer: str) -> dict[str, Any]:
    """Return the style of the switch of a layer, in the colour that its edges are drawn in."""
    color = to_hex(theme_of(state).edges[KINDS[layer]])
    checked = "& .MuiSwitch-switchBase.Mui-checked"
    return {checked: {"color": color}, f"{checked} + .MuiSwitch-track": {"bgcolor": color}}


def _resolutions(state: State) -> dict[str, int]:
    """Return a resolution that is easy to read, and the one of the weights."""
    other = state.graph_resolution or READABLE
    return {f"R = {other}": other, f"Weights: R = {state.resolution}": 0}


def _library(name: str, title: str) -> Any:
    """Return the choice of a library, if there is another one."""
    return ui.choice(name, title) if len(Choices.param[name].objects) > 1 else []


def _whole(state: State) -> bool:
    return not state.slicing


def _cut(state: State) -> bool:
    return state.cut_axis != "off" and not state.slicing


def _has_field(state: State) -> bool:
    """Return whether the edges or the face of the cut have the colours of a colour map."""
    return _whole(state) and (
        state.edge_colors in ("depth", "distance") or (_cut(state) and state.graph_face == "field")
    )


def _is_idle(state: State) -> bool:
    """Return whether the open character has no results and no computation runs."""
    return state.rig is not None and not (state.binding or state.built_graph or state.busy)


def _has_inverted_faces(state: State) -> bool:
    return state.binding is not None and bool(state.binding.graph.inverted.any())


CONTROLS = ui.column(
    ui.intro("The paths that distances are measured on: along the mesh and through the inside."),
    ui.section("Resolution", ui.choice("graph_resolution", options=_resolutions)),
    ui.section(
        "Layers",
        [_layer(layer) for layer in LAYERS],
        ui.column(
            ui.switch("nodes", margin=(1, 0)),
            ui.caption("Click a node: a card tells all of it.", visible=lambda s: s.nodes),
            visible=_whole,
        ),
        ui.choice("edge_colors", visible=_whole),
        ui.select("colormap", "Colour map", visible=_has_field, margin=(10, 0, 4, 0)),
        ui.caption(
            "The chosen bone carries no weight, so no distance begins at it.",
            visible=lambda s: s.edge_colors == "distance" and _whole(s) and ui.weightless(s),
        ),
    ),
    ui.section(
        "Look inside",
        ui.column(CUTTING, visible=_whole),
        ui.choice("graph_face", "Cut face", visible=_cut),
        ui.choice("cut_keeps", "Keep behind", visible=_cut),
        ui.slider("slab", visible=lambda s: _cut(s) and s.cut_keeps == "slab"),
        ui.switch("slicing", margin=(6, 0, 2, 0)),
        ui.column(
            ui.choice("slice_axis", "Slice normal"),
            ui.choice("slice_rays", "Ray direction"),
            ui.slider("slice_position"),
            _library("slice_caster", "Rays by"),
            _library("slice_winding", "Winding numbers by"),
            ui.caption("Rest the pointer on a ray: it tells the winding number there."),
            visible=lambda s: s.slicing or bool(s.flat),
        ),
        ui.choice("flat", "Flat scene", above=4),
    ),
    ui.section(
        "Build",
        # The box may move the slider's ends, which are reset here.
        ui.slider(
            "resolution",
            pmui.EditableIntSlider,
            watched="value_throttled",
            start=lambda s: min(16, s.resolution),
            end=lambda s: max(160, s.resolution),
            step=8,
        ),
        ui.option("winding_threshold"),
        ui.option("orient", visible=lambda s: not s.orient or _has_inverted_faces(s)),
        ui.option("connectivity"),
        ui.caption(SEARCHED, visible=lambda s: s.connectivity == "any"),
        [ui.option(name) for name in GRAPH if name not in PLACED],
        ui.button("Recompute", lambda session: session.engine.retry(*CHAIN), visible=_is_idle),
    ),
)
