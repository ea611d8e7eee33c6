"""The sidebar: character and bone, the tabs, the chosen panel's controls, take along."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui

from .panels import PANELS
from .panels.bone import bone
from .panels.character import character
from .panels.take_along import take_along
from .session import Session
from .tabs import Tabs


def sidebar(session: Session) -> list[Any]:
    """Return what stands in the sidebar, from top to bottom."""
    return [character(session), bone(session), *panels(session), take_along(session)]


def panels(session: Session) -> tuple[Tabs, pmui.Column]:
    """Return the tabs, and the place that holds the chosen panel.

    A panel is built when it is first looked at.
    """
    state = session.state
    tabs = Tabs(
        value=state.panel,
        tabs=[(panel.id, panel.title, panel.icon) for panel in PANELS],
        margin=(10, 20, 0, 20),
        sizing_mode="stretch_width",
    )
    place = pmui.Column(margin=0, sizing_mode="stretch_width")
    built: dict[str, Any] = {}

    def shown(*events: Any) -> None:
        for panel in PANELS:
            if panel.id == state.panel:
                place.objects = [
                    built.get(panel.id) or built.setdefault(panel.id, panel.build(session))
                ]
        tabs.value = state.panel

    def chosen(event: Any) -> None:
        state.panel = event.new

    state.param.watch(shown, "panel")
    tabs.param.watch(chosen, "value")
    shown()
    return tabs, place
