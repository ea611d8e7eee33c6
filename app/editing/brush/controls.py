"""The brush: what it does to weights, how large and how strong it is."""

from ...document.state import State
from ...widgets import controls as ui
from ..correct.moving import mirror_of

SUMMARIES = {
    "smooth": "Smooths all unlocked joints.",
    "mask": "Paints the mask of the chosen layer. Ctrl erases.",
    "select": "Select the vertices that other tools may paint. Ctrl subtracts.",
}
HOW = (
    "Drag on the body to paint, elsewhere to orbit. Shift smooths, Ctrl subtracts. "
    "[ ] size, { } strength."
)


def _summary(state: State) -> str:
    if state.brush_mode in SUMMARIES:
        return SUMMARIES[state.brush_mode]
    if not ui.has_joint(state):
        return ""
    return f"Paints weights of {ui.joint_title(state.rig, state.joint)}, the selected bone."


def _has_mirror(state: State) -> bool:
    return state.rig is not None and state.own is not None and mirror_of(state) is not None


BRUSH = ui.folded(
    "Brush",
    ui.switch("brush"),
    ui.column(
        ui.choice("brush_mode"),
        ui.caption(_summary),
        ui.slider("brush_radius", format="0.0%"),
        ui.slider("brush_strength", visible=lambda s: s.brush_mode != "select"),
        ui.slider("brush_value", visible=lambda s: s.brush_mode == "replace"),
        ui.switch("brush_mirrored", visible=_has_mirror),
        ui.caption(HOW),
        visible=lambda s: s.brush,
    ),
    needed=lambda s: s.brush,
    visible=lambda s: s.binding is not None,
)
