"""The sidebar: character and bone, the tabs, the chosen panel's controls, export."""

from typing import Any

import panel_material_ui as pmui

from ..document.session import Session
from ..document.state import State
from ..editing.correct.template_controls import SKELETON
from ..features import FEATURES
from ..features.state import PANELS
from ..widgets import controls as ui
from ..widgets.tabs import Tabs
from .bone import BONE
from .character import CHARACTER
from .export_controls import BASE, EXPORT

NO_SKELETON = (
    "This mesh has no skeleton. Choose a template above, or drop a file with one. "
    "The graph can be explored."
)


def _is_alone(state: State) -> bool:
    """Return whether one character is shown, and not two that are compared."""
    return state.panel != "pairs" or state.opened is None


CHOSEN = ui.column(CHARACTER, SKELETON, BONE, visible=_is_alone)
EXPORTED = ui.column(BASE, EXPORT, visible=_is_alone)


def sidebar(session: Session) -> list[Any]:
    """Return the sidebar's contents, from top to bottom."""
    return [ui.draw(session, CHOSEN), *panels(session), ui.draw(session, EXPORTED)]


def panels(session: Session) -> tuple[Tabs, pmui.Column]:
    """Return the tabs, and the place that holds the panels, of which the chosen one is seen.

    A panel is built when it is first looked at, and stays: to build it again in the browser takes
    longer than all that is computed for it.
    """
    state = session.state
    offered = {name: one for name, one in PANELS.items() if state.opened or not one.needs_audit}
    icons = [(name, panel.title, panel.icon) for name, panel in offered.items()]
    tabs = ui.Control(Tabs, "panel", label="Panels", tabs=icons, margin=(10, 20, 0, 20), **ui.WIDE)
    missing = ui.intro(NO_SKELETON, visible=lambda s: not s.is_panel_usable)
    place = ui.draw(session, ui.column(missing))
    built: dict[str, Any] = {}

    def update(*events: Any) -> None:
        if state.panel not in built and state.is_panel_usable:
            built[state.panel] = ui.draw(session, FEATURES[state.panel].controls, state.panel)
            place.append(built[state.panel])
        for panel, controls in built.items():
            controls.visible = panel == state.panel and state.is_panel_usable

    state.param.watch(update, ["panel", "rig"])
    update()
    return ui.draw(session, tabs), place
