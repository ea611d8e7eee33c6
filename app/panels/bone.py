"""Choose a bone."""

from typing import Any

import panel_material_ui as pmui

from cutcell_viewers.short_names import short_names

from ..commands.session import Session
from .controls import offer, row, section, select_box, unique_names, when

TOGGLES = (
    ("skeleton", "visibility_off", "visibility", "Show the bones"),
    ("faint_skeleton", "opacity", "water_drop", "Fade the bones"),
    ("wireframe", "grid_off", "grid_on", "Show the wireframe"),
)
"""Switches beside the bone: choice, icons off and on, and help."""


def bone(session: Session) -> pmui.Column:
    """Return the section of the chosen bone."""
    state = session.state
    select = select_box("Bone", searchable=True)

    def listed(*events: Any) -> None:
        names = () if state.rig is None else state.rig.skeleton.names
        offer(select, unique_names(short_names(names)), state.joint)

    def chosen(event: Any) -> None:
        if event.new is not None:
            state.joint = select.options.index(event.new)

    state.param.watch(listed, ["rig", "joint"])
    select.param.watch(chosen, "value")
    listed()
    toggles = [
        pmui.ToggleIcon.from_param(
            state.param[name],
            label="",
            icon=icon,
            active_icon=active,
            description=description,
            size="18px",
            margin=(4, 0, 0, 6),
        )
        for name, icon, active, description in TOGGLES
    ]
    chooser = row(select, *toggles)
    has_skeleton = when(lambda rig: not state.bare, state.param.rig)
    return section("", chooser, margin=(2, 20, 4, 20), visible=has_skeleton)
