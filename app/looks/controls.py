"""Controls of several panels: the cutting plane, and rest after a pose."""

from ..document.state import State
from ..widgets import controls as ui
from .cut import face_the_eye
from .pose import rest

AXES = {"Whole": "off", "Cut X": "x", "Cut Y": "y", "Cut Z": "z", "Free": "free"}


def _free(state: State) -> bool:
    return bool(state.cut_axis == "free")


def _cut(state: State) -> bool:
    return bool(state.cut_across != "off")


CUTTING = (
    ui.choice("cut_axis", options=AXES, value=lambda s: s.cut_across),
    ui.slider("cut_position", visible=_cut),
    ui.slider("cut_yaw", format="0°", visible=_free),
    ui.slider("cut_pitch", format="0°", visible=_free),
    ui.button("Face camera", face_the_eye, visible=_free),
    ui.caption("Or drag its handles in the scene.", visible=_cut),
)
"""Rows: a plane, where it lies, and where a free one looks to."""


REST = ui.button("Rest pose", rest, disabled=lambda s: not s.posed)
