"""Joints that are added, removed and hung on others."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui

from ..commands import structure as actions
from ..commands.session import Session
from .controls import GAP, caption, unique_names

NOTHING = "None (root)"


def structure(session: Session) -> pmui.Column:
    """Return what changes which joints there are."""
    state = session.state
    on = pmui.Select(
        label="Parent", options=[NOTHING], value=NOTHING, size="small", margin=(8, 0),
        sizing_mode="stretch_width",
    )  # fmt: skip
    style: dict[str, Any] = {"size": "small", "variant": "outlined", "sizing_mode": "stretch_width"}
    add, remove = (
        pmui.Button(label=label, icon=icon, margin=margin, on_click=done, **style)
        for label, icon, margin, done in (
            ("Add joint", "add", (4, 4, 4, 0), lambda event: actions.add(session)),
            ("Remove joint", "remove", (4, 0, 4, 4), lambda event: actions.remove(session)),
        )
    )
    cache: dict[str, list[str]] = {"names": []}

    def update(*events: Any) -> None:
        if state.rig is None or state.joint >= len(state.rig.skeleton.names):
            return
        skeleton = state.rig.skeleton
        names = actions.may_hang_on(state.rig, state.joint)
        titles, parent = unique_names(names), int(skeleton.parents[state.joint])
        cache["names"] = names
        value = titles[names.index(skeleton.names[parent])] if parent >= 0 else NOTHING
        on.param.update(options=[NOTHING, *titles], value=value)

    def chosen(event: Any) -> None:
        titles = unique_names(cache["names"])
        if event.new == NOTHING or event.new in titles:
            parent = "" if event.new == NOTHING else cache["names"][titles.index(event.new)]
            actions.hang_on(session, parent)

    on.param.watch(chosen, "value")
    state.param.watch(update, ["rig", "joint", "corrections"])
    update()
    return pmui.Column(
        on,
        pmui.Row(add, remove, margin=0, sizing_mode="stretch_width"),
        caption("Splits the bone; on a leaf or fork it starts a new one."),
        margin=GAP,
        sizing_mode="stretch_width",
    )
