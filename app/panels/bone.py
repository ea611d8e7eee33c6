"""Choose a bone."""

from typing import Any

import panel_material_ui as pmui

from ..commands.session import Session
from .controls import offer, row, section, select_box, unique_names, when


def bone(session: Session) -> pmui.Column:
    """Return the section of the chosen bone."""
    state = session.state
    select = select_box("Bone", searchable=True)

    def listed(*events: Any) -> None:
        names = () if state.rig is None else state.rig.skeleton.names
        offer(select, unique_names(names), state.joint)

    def chosen(event: Any) -> None:
        if event.new is not None:
            state.joint = select.options.index(event.new)

    state.param.watch(listed, ["rig", "joint"])
    select.param.watch(chosen, "value")
    listed()
    toggle = pmui.ToggleIcon.from_param(
        state.param.skeleton,
        label="",
        icon="visibility_off",
        active_icon="visibility",
        description="Show the bones",
        size="18px",
        margin=(4, 0, 0, 8),
    )
    chooser = row(select, toggle)
    has_skeleton = when(lambda rig: not state.bare, state.param.rig)
    return section("", chooser, margin=(2, 20, 4, 20), visible=has_skeleton)
