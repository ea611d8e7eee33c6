"""The skeleton of a mesh that its file has none for: which template is fitted into it."""

from typing import Any

from cutcell.templates import TEMPLATES

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from . import templates

NONE = "None"
CHANGED = "Your own"
TITLES = {template.capitalize(): template for template in TEMPLATES}
HINT = "This mesh has no skeleton. Choose a template to fit, then drag its joints."


def chosen_template(state: State) -> str:
    """Return the menu's word for the skeleton that was given to a mesh."""
    added = {name for name, one in state.edits.joints.items() if one.added}
    if not added:
        return NONE
    for title, template in TITLES.items():
        if templates.is_template(added, template):
            return title
    return CHANGED


def _offered(state: State) -> dict[str, Any]:
    """Return the templates, and the chosen one."""
    # Also after a message, where nothing came of a choice: the menu is reset.
    now, _ = chosen_template(state), (state.rig, state.message)
    return {"options": [NONE, *TITLES, *([CHANGED] if now == CHANGED else [])], "value": now}


def _choose(session: Session, title: str) -> None:
    if title == NONE:
        templates.take_out(session)
    elif title in TITLES:
        templates.fit(session, TITLES[title])


SKELETON = ui.section(
    "",
    ui.select("", "Skeleton", act=_choose, shows=_offered),
    ui.caption(HINT, visible=lambda state: state.bare),
    top=2,
    visible=lambda state: state.own is not None and not len(state.own.skeleton.joints),
)
