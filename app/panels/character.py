"""Choose a demo character, or drop a file."""

from typing import Any

import panel_material_ui as pmui

from cutcell.runtime.display import shown_name
from cutcell_assets import DEMOS

from ..commands.loading import load_again, load_demo, receiver
from ..commands.session import Session
from ..files.receive import MAX_UPLOAD
from ..state import State
from ..widgets.file_drop import FileDrop
from .controls import GAP, as_text, caption, section, select_box, unique_names

MAX_FAULTS = 2
"""The panel Check lists all."""
OWN = "Your own"
HINT = f"GLB, glTF, VRM, FBX, USD, OBJ, … · up to {MAX_UPLOAD // 2**20} MB"


def character(session: Session) -> pmui.Column:
    """Return the section that opens characters."""
    state = session.state
    demos = {demo.title: demo.id for demo in DEMOS if demo.path.exists()}
    select = select_box("Character", demos, value=None)
    lesson = caption()

    def chosen(event: Any) -> None:
        if event.new is not None and event.new != now():
            if event.new in demos.values():
                load_demo(session, event.new)
            else:
                load_again(session, event.new)

    def now() -> str:
        return state.demo or f"~{session.uploads.key}"

    def update(*events: Any) -> None:
        listed = session.uploads.offered()
        choices = {} if now() == "~" and session.given is None else {OWN: "~"}
        if session.given is not None:
            choices = {shown_name(session.given[0].name): "~"}
        elif state.demo or session.uploads.key in listed:
            choices = {}
        names = unique_names(list(listed.values()))
        opened = {name: f"~{key}" for name, key in zip(names, listed, strict=True)}
        select.param.update(options={**choices, **opened, **demos}, value=now())
        lessons = {demo.id: demo.lesson for demo in DEMOS}
        problems = faults(state)
        name = state.rig.name + ":" * bool(problems) if state.rig else ""
        lesson.object = as_text(" ".join([lessons.get(state.demo) or name, *problems]))

    select.param.watch(chosen, "value")
    state.param.watch(update, ["demo", "rig", "diagnosis"])
    update()
    drop = FileDrop(receiver(session), hint=HINT, sizing_mode="stretch_width", margin=GAP)
    return section("", select, lesson, drop, margin=(16, 20, 4, 20))


def faults(state: State) -> list[str]:
    """Return what the diagnosis says of the character, but for what is only good to know."""
    if state.diagnosis is None:
        return []
    severe = [f for f in state.diagnosis.findings if f.severity != "note"]
    return [finding.message for finding in severe[:MAX_FAULTS]]
