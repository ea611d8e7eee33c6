"""Choose a demo character, or drop a file."""

from functools import partial
from typing import Any

from cutcell.runtime.display import shown_name
from cutcell_assets import DEMOS

from ..document.loading import load_again, load_demo, receiver
from ..document.session import Session
from ..document.state import State
from ..files.receive import MAX_UPLOAD
from ..widgets import controls as ui
from ..widgets.file_drop import FileDrop

MAX_FAULTS = 2
"""The panel Check lists all."""
OWN = "Your own"
HINT = f"GLB, glTF, VRM, FBX, USD, OBJ, … · up to {MAX_UPLOAD // 2**20} MB"
LESSONS = {demo.id: demo.lesson for demo in DEMOS}


def faults(state: State) -> list[str]:
    """Return the messages of findings that are more severe than notes."""
    severe = [f for f in state.open_findings if f.severity != "note"]
    return [finding.message for finding in severe[:MAX_FAULTS]]


def _characters(session: Session, state: State) -> dict[str, Any]:
    """Return the characters that can be opened, and the open one."""
    uploads, paths, _ = session.uploads, session.paths, state.rig
    # A menu without its value would open the first demo; one whose value stays keeps its name.
    now = state.demo or (OWN if paths is None and not uploads.key else f"~{uploads.key}")
    listed = uploads.offered()
    choices = {OWN: now}
    if paths is not None:
        choices = {shown_name(paths[0].name): "~"}
    elif state.demo or uploads.key in listed:
        choices = {}
    names = ui.unique_names(list(listed.values()))
    opened = {name: f"~{key}" for name, key in zip(names, listed, strict=True)}
    demos = {demo.title: demo.id for demo in DEMOS if demo.path.exists()}
    return {"options": {**choices, **opened, **demos}, "value": now}


def _open(session: Session, chosen: str) -> None:
    if chosen in LESSONS:
        load_demo(session, chosen)
    else:
        load_again(session, chosen)


def about(state: State) -> str:
    """Return what a demo shows, or a file's name, and what is wrong with the character.

    Empty while a step of the lesson asks: the text would give the answer away.
    """
    if state.lesson_step is not None and state.step not in state.answers:
        return ""
    problems = faults(state)
    name = state.rig.name + ", in the file:" * bool(problems) if state.rig else ""
    return " ".join([LESSONS.get(state.demo) or name, *problems])


def _drop(session: Session) -> FileDrop:
    return FileDrop(receiver(session), hint=HINT, margin=ui.GAP, **ui.WIDE)


def _choice(session: Session) -> ui.Control:
    return ui.select("", "Character", act=_open, shows=partial(_characters, session))


CHARACTER = ui.section("", _choice, ui.caption(about), _drop, top=16)
