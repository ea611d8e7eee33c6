"""The choice of a cutting plane, and what moves and turns it."""

from typing import Any

import panel_material_ui as pmui

from ..commands import cutting as actions
from ..commands.session import Session
from .controls import BUTTONS, button, caption, follow, slider, when

AXES = {"Whole": "off", "Cut X": "x", "Cut Y": "y", "Cut Z": "z", "Free": "free"}


def cutting(session: Session) -> list[Any]:
    """Return the choice of a plane, where it lies, and where a free one looks to."""
    state = session.state
    cut = when(lambda *_: state.cut_across != "off", state.param.cut_axis, state.param.panel)
    free = when(lambda axis: axis == "free", state.param.cut_axis)
    style = {"format": "0°", "step": 1, "visible": free}
    facing = button("Face camera", lambda: actions.face_the_eye(session), visible=free)
    return [
        follow(
            pmui.RadioButtonGroup(**BUTTONS),
            state,
            "cut_axis",
            lambda: (AXES, state.cut_across),
            ["panel"],
        ),
        slider(state.param.cut_position, "Position", step=0.005, visible=cut),
        slider(state.param.cut_yaw, "Yaw", **style),
        slider(state.param.cut_pitch, "Pitch", **style),
        facing,
        caption("Or drag its handles in the scene.", visible=cut),
    ]
