"""The list of joints that deform: seen, and changed."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel_material_ui as pmui

from cutcell.deform import DeformJoints
from cutcell.rig import Rig

from ..commands import deform
from ..commands.session import Session
from .parts import GAP, caption, section, unique_names, when

SHOWN = "Hide the list"
HIDDEN = "Choose joints"


def deforming(session: Session) -> pmui.Column:
    """Return the section that tells which joints carry weight, and lets a person choose.

    The list is made when it is first asked for: some skeletons have thousands of joints.
    """
    state = session.state
    counts = caption(when(_counted, state.param.rig))
    boxes = pmui.CheckBoxGroup(
        options=[], value=[], size="small", margin=0, sizing_mode="stretch_width"
    )
    place = pmui.Column(
        margin=GAP,
        sizing_mode="stretch_width",
        visible=False,
        max_height=260,
        scroll="y",
    )
    opener = pmui.Button(label=HIDDEN, size="small", variant="outlined", margin=GAP)
    guesser = pmui.Button(label="Guess anew", size="small", variant="text", margin=GAP)
    listed: list[str] = []

    def show(found: DeformJoints) -> None:
        names = unique_names(state.rig.skeleton.names)
        listed[:] = [
            f"{name} — {reason}" if reason else name
            for name, reason in zip(names, _reasons(state.rig, found), strict=True)
        ]
        boxes.param.update(options=listed[:], value=_chosen())
        place.objects = [boxes]

    def _chosen() -> list[str]:
        return [listed[j] for j in np.flatnonzero(state.rig.skeleton.deform)]

    def opened(event: Any) -> None:
        place.visible = not place.visible
        opener.label = SHOWN if place.visible else HIDDEN
        relisted()

    def relisted(*events: Any) -> None:
        if not place.visible or state.rig is None:
            return
        if len(listed) == len(state.rig.skeleton.joints) and events and _same(events[0]):
            boxes.value = _chosen()
        else:
            deform.guess(session, show)

    def changed(event: Any) -> None:
        if event.new != _chosen():
            deform.choose(session, [listed.index(name) for name in event.new])
            boxes.value = _chosen()

    def guessed(event: Any) -> None:
        deform.guess(session, lambda found: deform.choose(session, np.flatnonzero(found.deform)))

    boxes.param.watch(changed, "value")
    opener.on_click(opened)
    guesser.on_click(guessed)
    state.param.watch(relisted, "rig")
    buttons = pmui.Row(opener, guesser, margin=0, sizing_mode="stretch_width")
    return section("Joints that deform", counts, buttons, place)


def _reasons(rig: Rig, found: DeformJoints) -> list[str]:
    """Say why joints carry no weight; nothing of those that do."""
    reasons = [
        "" if deforms else why for deforms, why in zip(found.deform, found.reason, strict=True)
    ]
    if rig.weights is not None:
        for j in np.flatnonzero(found.deform & ~rig.weights.any(axis=0)):
            reasons[j] = "no weight in the file"
    return reasons


def _counted(rig: Any) -> str:
    if rig is None:
        return ""
    chosen = rig.skeleton.deform
    if chosen.all():
        return f"All {len(chosen)} joints may carry weight."
    return f"{chosen.sum()} of {len(chosen)} joints may carry weight."


def _same(event: Any) -> bool:
    """Tell whether a rig took the place of one with the same joints."""
    return event.old is not None and event.old.skeleton.names == event.new.skeleton.names
