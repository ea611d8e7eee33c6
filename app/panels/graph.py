"""The graph: how it is built, which of its layers are seen, and where it is cut."""

from typing import Any

import numpy as np
import panel_material_ui as pmui

from cutcell.geodesics import LEAVES
from cutcell.graph import INTERIOR, MESH, SURFACE
from cutcell_viewers.palette import to_hex

from ..commands.binding import bind
from ..commands.session import Session
from ..scenes.common import theme_of
from ..state import LAYERS, State
from ..state.graph import READABLE
from .controls import (
    BUTTONS,
    GAP,
    caption,
    choice,
    follow,
    intro,
    section,
    slider,
    text_line,
    weightless,
    when,
)
from .cutting import cutting

KINDS = {"mesh_edges": MESH, "interior_edges": INTERIOR, "surface_edges": SURFACE}
LEAF_TITLES = {"point": "Points", "extend": "Extended", "fit": "Fitted"}
LIBRARY_TITLES = {
    "raster": "cutcell",
    "open3d": "Open3D",
    "embree": "Embree",
    "exact": "cutcell, exact",
    "fast": "libigl, fast",
}
SEARCHED = (
    "Interior edges only carry the search: paths run straight along lines of sight. Click the "
    "body to see them."
)
"""Description of interior edges where paths need not follow them."""
AXES = {"X": "x", "Y": "y", "Z": "z"}


def graph(session: Session) -> pmui.Column:
    """Return the controls of the panel Graph."""
    state = session.state
    return pmui.Column(
        intro("The paths that distances are measured on: along the mesh and through the inside."),
        section("Resolution", _resolution(state)),
        section(
            "Layers", *[_layer(state, name) for name in LAYERS], _nodes(state), *_colors(state)
        ),
        section("Look inside", *_inside(session)),
        section("Build", *_build(session)),
        margin=0,
        sizing_mode="stretch_width",
    )


def _resolution(state: State) -> pmui.RadioButtonGroup:
    """Return the choice between a graph that is easy to read and the one of the weights."""

    def options() -> tuple[dict[str, int], int]:
        other = state.graph_resolution or READABLE
        return {f"R = {other}": other, f"Weights: R = {state.resolution}": 0}, (
            state.graph_resolution
        )

    menu = pmui.RadioButtonGroup(**BUTTONS)
    return follow(menu, state, "graph_resolution", options, ["resolution"])


def _layer(state: State, name: str) -> pmui.Row:
    switch = pmui.Switch.from_param(
        state.param[name],
        label=state.param[name].label,
        size="small",
        margin=(1, 0),
        sx=when(lambda _: _switch_colors(state, name), state.param.dark) if name in KINDS else {},
    )
    number = text_line(
        when(lambda *_: count(state, name), *_built(state), state.param.rig),
        sx={
            "fontSize": "12px",
            "color": "text.secondary",
            "fontVariantNumeric": "tabular-nums",
            "textAlign": "right",
        },
        margin=(3, 0),
        width=110,
    )
    spacer = pmui.Column(sizing_mode="stretch_width", margin=0)
    # A slice shows rays instead of edges.
    visible = name == "body" or when(lambda slicing: not slicing, state.param.slicing)
    return pmui.Row(switch, spacer, number, sizing_mode="stretch_width", margin=0, visible=visible)


def _switch_colors(state: State, layer: str) -> dict[str, Any]:
    """Return the style of the switch of a layer, in the colour that its edges are drawn in."""
    color = to_hex(theme_of(state).edges[KINDS[layer]])
    checked = "& .MuiSwitch-switchBase.Mui-checked"
    return {checked: {"color": color}, f"{checked} + .MuiSwitch-track": {"bgcolor": color}}


def _nodes(state: State) -> pmui.Column:
    """Return the switch of the nodes of the layers that are seen."""
    switch = pmui.Switch.from_param(
        state.param.nodes, label="Nodes", size="small", margin=(1, 0), description=""
    )
    hint = caption("Click a node: a card tells all of it.", visible=state.param.nodes)
    no_slice = when(lambda slicing: not slicing, state.param.slicing)
    return pmui.Column(switch, hint, margin=0, sizing_mode="stretch_width", visible=no_slice)


def count(state: State, layer: str) -> str:
    """Return how many faces or edges a layer has, as text."""
    if layer == "body":
        return "" if state.rig is None else f"{len(state.rig.mesh.faces):,} faces"
    if state.shown_graph is None:
        return ""
    return f"{np.count_nonzero(state.shown_graph.edge_kind == KINDS[layer]):,}"


def _colors(state: State) -> list[Any]:
    idle = caption(
        "The chosen bone carries no weight, so no distance begins at it.",
        visible=when(
            lambda update, rig, joint, slicing: (
                update == "distance" and not slicing and weightless(rig, joint)
            ),
            state.param.edge_colors,
            state.param.rig,
            state.param.joint,
            state.param.slicing,
        ),
    )
    options = {"Kind": "kind", "Depth": "depth", "Distance": "distance", "Part": "component"}
    no_slice = when(lambda slicing: not slicing, state.param.slicing)
    return [choice(state.param.edge_colors, options, visible=no_slice), idle]


def _inside(session: Session) -> list[Any]:
    state = session.state
    whole = when(lambda slicing: not slicing, state.param.slicing)
    cut = when(lambda axis, slicing: axis != "off" and not slicing, *_cut(state))
    thick = when(
        lambda axis, slicing, keeps: axis != "off" and not slicing and keeps == "slab",
        *_cut(state),
        state.param.cut_keeps,
    )
    faces = {"Open": "open", "Distance": "field", "Winding": "winding"}
    keeps = {"Half": "half", "Face only": "face", "Slab": "slab"}
    return [
        pmui.Column(*cutting(session), margin=0, sizing_mode="stretch_width", visible=whole),
        caption("Cut face", margin=(2, 0, 0, 0), visible=cut),
        choice(state.param.graph_face, faces, visible=cut),
        caption("Keep behind", margin=(2, 0, 0, 0), visible=cut),
        choice(state.param.cut_keeps, keeps, visible=cut),
        slider(state.param.slab, "Thickness of the slab", step=0.01, visible=thick),
        pmui.Switch.from_param(
            state.param.slicing,
            label="One slice and its rays",
            size="small",
            margin=(6, 0, 2, 0),
            description="",
        ),
        pmui.Column(
            caption("Slice normal", margin=(2, 0, 0, 0)),
            choice(state.param.slice_axis, AXES),
            caption("Ray direction", margin=(2, 0, 0, 0)),
            choice(state.param.slice_rays, AXES),
            slider(state.param.slice_position, "Position", step=0.005),
            *_libraries(state),
            caption("Rest the pointer on a ray: it tells the winding number there."),
            margin=0,
            sizing_mode="stretch_width",
            visible=state.param.slicing,
        ),
    ]


def _libraries(state: State) -> list[Any]:
    """Return what else can cast the rays and compute winding numbers, as far as installed."""
    controls = []
    for label, parameter in (
        ("Rays by", state.param.slice_caster),
        ("Winding numbers by", state.param.slice_winding),
    ):
        if len(parameter.objects) > 1:
            options = {LIBRARY_TITLES[name]: name for name in parameter.objects}
            controls += [caption(label, margin=(2, 0, 0, 0)), choice(parameter, options)]
    return controls


def _cut(state: State) -> tuple[Any, Any]:
    return state.param.cut_axis, state.param.slicing


def _built(state: State) -> tuple[Any, ...]:
    return state.param.binding, state.param.bare_graph, state.param.easy_graph


def _ends(value: int) -> dict[str, int]:
    """Return between which resolutions the slider moves: the useful ones, and the chosen one."""
    return {"start": min(16, value), "end": max(160, value)}


def _build(session: Session) -> list[Any]:
    state = session.state
    resolution = pmui.EditableIntSlider(
        label="Resolution",
        value=state.resolution,
        **_ends(state.resolution),
        step=8,
        size="small",
        margin=GAP,
        sizing_mode="stretch_width",
    )

    def chosen(event: Any) -> None:
        state.resolution = event.new

    def update(event: Any) -> None:
        # The box may move the slider's ends, which are reset here.
        resolution.param.update(value=event.new, **_ends(event.new))

    resolution.param.watch(chosen, "value_throttled")
    state.param.watch(update, "resolution")
    threshold = slider(state.param.winding_threshold, "Winding threshold τ", step=0.01)
    again = pmui.Button(
        label="Recompute",
        size="small",
        variant="outlined",
        margin=GAP,
        sizing_mode="stretch_width",
        on_click=lambda event: bind(session),
        visible=when(
            lambda rig, binding, bare, _, busy: rig is not None and not (binding or bare or busy),
            state.param.rig,
            *_built(state),
            state.param.busy,
        ),
    )
    orient = pmui.Switch.from_param(
        state.param.orient,
        label="Flip inverted faces",
        size="small",
        margin=(4, 0, 2, 0),
        description="",
        visible=when(
            lambda binding, orient: (
                not orient or (binding is not None and bool(binding.graph.inverted.any()))
            ),
            state.param.binding,
            state.param.orient,
        ),
    )
    return [
        resolution,
        threshold,
        orient,
        caption("Paths inside run along", margin=(4, 0, 0, 0)),
        choice(state.param.connectivity, {"6 axes": 6, "26 diagonals": 26, "Any angle": "any"}),
        caption(SEARCHED, visible=when(lambda value: value == "any", state.param.connectivity)),
        caption("Leaf bones", margin=(4, 0, 0, 0)),
        choice(state.param.leaf, {LEAF_TITLES.get(leaf, leaf): leaf for leaf in LEAVES}),
        again,
    ]
