"""Joints that are added, removed and hung on others."""

from typing import Any

import panel_material_ui as pmui

from cutcell_viewers.short_names import short_names

from ..commands import structure as actions
from ..commands.session import Session
from .controls import GAP, button, caption, column, row, select_box, unique_names

NOTHING = "None (root)"


def structure(session: Session) -> pmui.Column:
    """Return what changes which joints there are."""
    state = session.state
    on = select_box("Parent", [NOTHING], value=NOTHING, margin=(8, 0))
    add = button("Add joint", lambda: actions.add(session), icon="add", margin=(4, 4, 4, 0))
    remove = button(
        "Remove joint", lambda: actions.remove(session), icon="remove", margin=(4, 0, 4, 4)
    )
    cache: dict[str, str] = {}  # the joint of each title

    def update(*events: Any) -> None:
        if state.rig is None or state.joint >= len(state.rig.skeleton.names):
            return
        skeleton = state.rig.skeleton
        names = actions.may_hang_on(state.rig, state.joint)
        shorts = dict(zip(skeleton.names, short_names(skeleton.names), strict=True))
        titles = unique_names([shorts[name] for name in names])
        parent = int(skeleton.parents[state.joint])
        cache.clear()
        cache.update(zip(titles, names, strict=True))
        value = titles[names.index(skeleton.names[parent])] if parent >= 0 else NOTHING
        on.param.update(options=[NOTHING, *titles], value=value)

    def chosen(event: Any) -> None:
        if event.new == NOTHING or event.new in cache:
            actions.hang_on(session, cache.get(event.new, ""))

    on.param.watch(chosen, "value")
    state.param.watch(update, ["rig", "joint", "corrections"])
    update()
    return column(
        on,
        row(add, remove),
        caption("Splits the bone; on a leaf or fork it starts a new one."),
        margin=GAP,
    )
