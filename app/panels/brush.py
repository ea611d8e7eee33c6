"""The brush: what it does to weights, how large and how strong it is."""

from typing import Any

import numpy as np
import panel_material_ui as pmui

from ..commands.brush import clear_selection, invert_selection
from ..commands.correct import keep_file_vertices
from ..commands.moving import mirror_of
from ..commands.session import Session
from ..state.brush import MAX_RADIUS, selected
from .controls import (
    BESIDE,
    button,
    caption,
    choice,
    column,
    folded,
    has_weights,
    joint_title,
    row,
    slider,
    switch,
    when,
)

MODES = {"Add": "add", "Subtract": "subtract", "Replace": "replace", "Smooth": "smooth",
         "Select": "select"}  # fmt: skip
HOW = (
    "Drag on the body to paint, elsewhere to orbit. Shift smooths, Ctrl subtracts. "
    "[ ] size, { } strength."
)


def brush(session: Session) -> pmui.Column:
    """Return the section of the brush."""
    state = session.state
    mirrored = switch(state.param.brush_mirrored)

    def has_mirror(rig: Any, original: Any, corrections: Any) -> bool:
        return rig is not None and original is not None and mirror_of(session) is not None

    mirrored.visible = when(has_mirror, state.param.rig, state.param.own, state.param.corrections)
    tools = column(
        choice(state.param.brush_mode, MODES),
        caption(when(_summary, state.param.rig, state.param.joint, state.param.brush_mode)),
        slider(
            state.param.brush_radius, "Radius (% of size)", step=0.005,
            end=MAX_RADIUS, format="0.0%",
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
    painting = state.param.brush
    return folded("Brush", switch(painting), tools, needed=painting, visible=has_binding)


def _selection(session: Session) -> pmui.Column:
    """Return what tells of the vertices that strokes are limited to."""
    state = session.state

    def summary(selection: Any, rig: Any) -> str:
        chosen = selected(state)
        if chosen is None:
            return ""
        count = int(chosen.sum())
        which = "one vertex" if count == 1 else f"{count:,} vertices"
        return f"Strokes are limited to {which} of {len(chosen):,}, marked by dots."

    changing = state.param.brush_selection, state.param.rig
    from_file = button(
        "As in the file",
        lambda: keep_file_vertices(session, np.flatnonzero(state.brush_selection.chosen)),
        icon="history",
        visible=when(has_weights, state.param.rig),
    )
    return column(
        caption(when(summary, *changing)),
        row(
            button("Clear", lambda: clear_selection(session), margin=BESIDE),
            button("Invert", lambda: invert_selection(session)),
        ),
        from_file,
        visible=when(lambda *which: selected(state) is not None, *changing),
    )


def _summary(rig: Any, joint: int, mode: str) -> str:
    if mode == "smooth":
        return "Smooths all unlocked joints."
    if mode == "select":
        return "Select the vertices that other tools may paint. Ctrl subtracts."
    if rig is None or joint >= len(rig.skeleton.names):
        return ""
    return f"Paints weights of {joint_title(rig, joint)}, the selected bone."
