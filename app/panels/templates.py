"""The skeleton of a mesh that its file has none for: which template is fitted into it."""

from typing import Any

import panel_material_ui as pmui

from cutcell.templates import TEMPLATES

from ..commands import templates
from ..commands.session import Session
from ..state import State
from .controls import caption, section, select_box, when

NONE = "None"
CHANGED = "Your own"
TITLES = {template.capitalize(): template for template in TEMPLATES}
HINT = "This mesh has no skeleton. Choose a template to fit, then drag its joints."


def skeleton_menu(session: Session) -> pmui.Column:
    """Return the section that gives a mesh without a skeleton one."""
    state = session.state
    select = select_box("Skeleton", [NONE, *TITLES], value=NONE)
    hint = caption(HINT, visible=when(lambda rig: rig is not None and state.bare, state.param.rig))

    def update(*events: Any) -> None:
        now = chosen_template(state)
        options = [NONE, *TITLES, *([CHANGED] if now == CHANGED else [])]
        select.param.update(options=options, value=now)

    def chosen(event: Any) -> None:
        if event.new is None or event.new == chosen_template(state):
            return
        if event.new == NONE:
            templates.take_out(session)
        elif event.new in TITLES:
            templates.fit(session, TITLES[event.new])

    select.param.watch(chosen, "value")
    # Also where nothing came of it: the menu then says again what there is.
    state.param.watch(update, ["rig", "corrections", "message"])
    update()
    of_bare = when(lambda own: own is not None and not len(own.skeleton.joints), state.param.own)
    return section("", select, hint, margin=(2, 20, 4, 20), visible=of_bare)


def chosen_template(state: State) -> str:
    """Return the menu's word for the skeleton that was given to a mesh."""
    added = {name for name, one in state.corrections.joints.items() if one.added}
    if not added:
        return NONE
    for title, template in TITLES.items():
        if templates.is_template(added, template):
            return title
    return CHANGED
