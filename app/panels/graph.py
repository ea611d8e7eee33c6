"""The graph: how fine it is, which of its layers are seen, and where it is cut."""

from __future__ import annotations

from typing import Any

import panel as pn
import panel_material_ui as pmui

from ..session import Session
from ..state import LAYERS
from ..theme import LAYER_COLORS
from .parts import GAP, cutting, section, when


def graph(session: Session) -> pmui.Column:
    """Return the section of the graph."""
    state = session.state
    resolution = pmui.EditableIntSlider(
        label="Resolution",
        value=state.resolution,
        start=16,
        end=160,
        step=8,
        size="small",
        margin=GAP,
        sizing_mode="stretch_width",
    )

    def chosen(event: Any) -> None:
        state.resolution = event.new

    resolution.param.watch(chosen, "value_throttled")
    again = pmui.Button(
        label="Compute again",
        size="small",
        variant="outlined",
        margin=GAP,
        sizing_mode="stretch_width",
        on_click=lambda event: session.bind(),
        visible=when(
            lambda rig, binding, busy: rig is not None and binding is None and not busy,
            state.param.rig,
            state.param.binding,
            state.param.busy,
        ),
    )
    layers = pn.GridBox(
        *[_layer(state, name) for name in LAYERS],
        ncols=2,
        sizing_mode="stretch_width",
        margin=GAP,
    )
    cut = when(lambda axis: axis != "off", state.param.cut_axis)
    thin = pmui.Switch.from_param(
        state.param.thin, label="Thin slice of the interior", size="small", visible=cut,
        margin=GAP, description="",
    )  # fmt: skip
    return section("Graph", resolution, again, layers, *cutting(state), thin)


def _layer(state: Any, name: str) -> pmui.Switch:
    color = LAYER_COLORS.get(name)
    checked = "& .MuiSwitch-switchBase.Mui-checked"
    look = {checked: {"color": color}, f"{checked} + .MuiSwitch-track": {"bgcolor": color}}
    return pmui.Switch.from_param(
        state.param[name],
        label=state.param[name].label,
        size="small",
        margin=(1, 0),
        sx=look if color else {},
    )
