"""Joints that are added, removed and hung on others."""

from typing import Any

from cutcell_viewers.short_names import short_names

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from . import structure as actions

NOTHING = "None (root)"


def _parents(state: State) -> dict[str, str]:
    """Return the possible parents of the chosen joint, by title."""
    skeleton = state.rig.skeleton
    names = actions.may_hang_on(state.rig, state.joint)
    shorts = dict(zip(skeleton.names, short_names(skeleton.names), strict=True))
    return dict(zip(ui.unique_names([shorts[name] for name in names]), names, strict=True))


def _parent(state: State) -> dict[str, Any]:
    """Return the titles of possible parents, and of the chosen joint's own."""
    if not ui.has_joint(state):
        return {"options": [NOTHING], "value": NOTHING}
    parents, skeleton = _parents(state), state.rig.skeleton
    parent = int(skeleton.parents[state.joint])
    named = skeleton.names[parent] if parent >= 0 else None
    value = next((title for title, name in parents.items() if name == named), NOTHING)
    return {"options": [NOTHING, *parents], "value": value}


def _hang(session: Session, title: str) -> None:
    parents = _parents(session.state)
    if title == NOTHING or title in parents:
        actions.hang_on(session, parents.get(title, ""))


STRUCTURE = ui.column(
    ui.select("", "Parent", act=_hang, shows=_parent, margin=(8, 0)),
    ui.row(
        ui.button("Add joint", actions.add, icon="add", margin=(4, 4, 4, 0)),
        ui.button("Remove joint", actions.remove, icon="remove", margin=(4, 0, 4, 4)),
    ),
    ui.caption("Splits the bone; on a leaf or fork it starts a new one."),
    margin=ui.GAP,
)
