"""The sidebar: character and bone, the tabs, the chosen panel's controls, export."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui

from ..commands.session import Session
from ..panels import PANELS
from ..panels.bone import bone
from ..panels.character import character
from ..panels.controls import intro, when
from ..panels.export import export
from ..panels.templates import skeleton_menu
from ..widgets.tabs import Tabs

BARE = ("graph", "check", "learn")
"""The panels for a mesh without a skeleton."""
NO_SKELETON = (
    "This mesh has no skeleton. Choose a template above, or drop a file with one. "
    "The graph can be explored."
)


def sidebar(session: Session) -> list[Any]:
    """Return the sidebar's contents, from top to bottom."""
    # Controls of one character are hidden while two are compared.
    alone = when(
        lambda panel, opened: panel != "pairs" or opened is None,
        session.state.param.panel,
        session.state.param.opened,
    )
    chosen, exported = (
        pmui.Column(*parts, margin=0, visible=alone, sizing_mode="stretch_width")
        for parts in (
            (character(session), skeleton_menu(session), bone(session)),
            (export(session),),
        )
    )
    return [chosen, *panels(session), exported]


def panels(session: Session) -> tuple[Tabs, pmui.Column]:
    """Return the tabs, and the place that holds the panels, of which the chosen one is seen.

    A panel is built when it is first looked at, and stays: to build it again in the browser takes
    longer than all that is computed for it.
    """
    state = session.state
    tabs = Tabs(
        value=state.panel,
        tabs=[(p.id, p.title, p.icon) for p in PANELS if p.id != "pairs" or state.opened],
        margin=(10, 20, 0, 20),
        sizing_mode="stretch_width",
    )
    missing = intro(NO_SKELETON)
    place = pmui.Column(missing, margin=0, sizing_mode="stretch_width")
    built: dict[str, Any] = {}

    def update(*events: Any) -> None:
        tabs.value = state.panel
        missing.visible = state.bare and state.panel not in BARE
        for panel in PANELS:
            is_visible = panel.id == state.panel and not missing.visible
            if panel.id in built:
                built[panel.id].visible = is_visible
            elif is_visible:
                built[panel.id] = panel.build(session)
                place.append(built[panel.id])

    def chosen(event: Any) -> None:
        state.panel = event.new

    state.param.watch(update, ["panel", "rig"])
    tabs.param.watch(chosen, "value")
    update()
    return tabs, place
