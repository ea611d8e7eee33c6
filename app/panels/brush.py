"""The brush: what it does to weights, how large and how strong it is."""

from typing import Any

import panel_material_ui as pmui

from cutcell.runtime.display import shown_name

from ..commands.brush import clear_selection, invert_selection
from ..commands.moving import mirror_of
from ..commands.session import Session
from ..state.brush import MAX_RADIUS, selected
from .controls import BESIDE, button, caption, choice, column, row, section, slider, switch, when

MODES = {"Add": "add", "Subtract": "subtract", "Replace": "replace", "Smooth": "smooth",
         "Select": "select"}  # fmt: skip
HOW = (
    "Drag over the body to paint, beside it or with the right button to turn it, with the middle "
    "button to move it; a finger beside it turns, two move. Shift while you paint smooths, Ctrl "
    "takes away. Keys: B, [ ] for the size, { } for the strength, Esc."
)


def brush(session: Session) -> pmui.Column:
    """Return the section of the brush."""
    state = session.state
    mirrored = switch(state.param.brush_mirrored)

    def has_mirror(rig: Any, own: Any, corrections: Any) -> bool:
        return rig is not None and own is not None and mirror_of(session) is not None

    mirrored.visible = when(has_mirror, state.param.rig, state.param.own, state.param.corrections)
    tools = column(
        choice(state.param.brush_mode, MODES),
        caption(when(_told, state.param.rig, state.param.joint, state.param.brush_mode)),
        slider(
            state.param.brush_radius, "Radius, of the character's longest side", step=0.005,
            end=MAX_RADIUS, format="0.0 %",
        ),
        slider(
            state.param.brush_strength, "Strength", step=0.05,
            visible=when(lambda mode: mode != "select", state.param.brush_mode),
        ),
        slider(
            state.param.brush_value, "Weight to paint", step=0.05,
            visible=when(lambda mode: mode == "replace", state.param.brush_mode),
        ),
        mirrored, _selection(session), caption(HOW), visible=state.param.brush,
    )  # fmt: skip
    has_binding = when(lambda binding: binding is not None, state.param.binding)
    return section("Brush", switch(state.param.brush), tools, visible=has_binding)


def _selection(session: Session) -> pmui.Column:
    """Return what tells of the vertices that strokes are limited to."""
    state = session.state

    def told(selection: Any, rig: Any) -> str:
        chosen = selected(state)
        if chosen is None:
            return ""
        count = int(chosen.sum())
        which = "one vertex" if count == 1 else f"{count:,} vertices"
        return f"Strokes stay on {which} of {len(chosen):,}, marked by dots."

    changing = state.param.brush_selection, state.param.rig
    return column(
        caption(when(told, *changing)),
        row(
            button("Clear", lambda: clear_selection(session), margin=BESIDE),
            button("Invert", lambda: invert_selection(session)),
        ),
        visible=when(lambda *which: selected(state) is not None, *changing),
    )


def _told(rig: Any, joint: int, mode: str) -> str:
    if mode == "smooth":
        return "Smooths all unlocked joints."
    if mode == "select":
        return "Selects what the other tools may paint; Ctrl takes away."
    if rig is None or joint >= len(rig.skeleton.names):
        return ""
    return f"Paints for {shown_name(rig.skeleton.names[joint])}, the chosen bone."
