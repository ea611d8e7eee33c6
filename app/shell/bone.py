"""Choose a bone."""

import panel_material_ui as pmui

from cutcell_viewers.short_names import short_names

from ..document.session import Session
from ..document.state import State
from ..widgets import controls as ui

TOGGLES = (
    ("skeleton", "visibility_off", "visibility", "Show the bones"),
    ("faint_skeleton", "opacity", "water_drop", "Fade the bones"),
    ("wireframe", "grid_off", "grid_on", "Show the wireframe"),
)
"""Switches beside the bone: choice, icons off and on, and help."""


def _names(state: State) -> list[str]:
    return [] if state.rig is None else short_names(state.rig.skeleton.names)


def _choose(session: Session, joint: int) -> None:
    session.state.joint = joint


BONE = ui.section(
    "",
    ui.row(
        ui.pick("Bone", _names, lambda state: state.joint, _choose, searchable=True),
        [
            ui.Control(
                pmui.ToggleIcon, name, label="", icon=icon, active_icon=active,
                description=description, size="18px", margin=(4, 0, 0, 6),
            )
            for name, icon, active, description in TOGGLES
        ],
    ),
    top=2,
    visible=lambda state: not state.bare,
)  # fmt: skip
