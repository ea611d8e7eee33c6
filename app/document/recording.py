"""Undo and redo of choices, and the address of the present ones."""

import re
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from cutcell.errors import CutcellError

from .address import NOTED, simple, snapshot, to_query
from .edits import changed_only
from .history import History
from .session import Session

OF_STEP = re.compile(r"&(?:step|answer|stage)=[^&]*")
RESULT = ("rig", "own", "repair")
"""Changes of the result besides the choices: other joints that deform, repaired faces."""


def watch(session: Session) -> None:
    """Keep the address and the history up to what is chosen."""
    state = session.state
    state.param.watch(lambda *events: _chosen(session), [*simple(state), *NOTED, *RESULT])
    state.param.watch(lambda *events: publish(session), ["step", "answers", "staged", "vertex"])
    session.view.on_camera = lambda: publish(session)


def begin(session: Session, before: str) -> None:
    """Begin the history of a new character, or continue that of one restored by *Back*.

    `before` is the key of the character that was open; see `Session.character`.
    """
    now = _now(session)
    if session.returning:
        session.returning = False
        session.history.replace_current(now)
    elif before and session.character:
        session.history.turn(now, RESULT)
    else:
        session.history = History(now)
    publish(session)


def plain(choices: dict[str, Any]) -> dict[str, Any]:
    """Return what of some choices the state holds, but for the character."""
    return {
        name: value for name, value in choices.items() if name not in ("rig", "own", "character")
    }


def withdraw(session: Session, choices: dict[str, Any]) -> None:
    """Choose something again in place of what cannot be; nobody goes back to that."""
    restore(session, choices)
    session.history.withdraw(_now(session))
    publish(session)


def restore(session: Session, choices: dict[str, Any]) -> None:
    """Choose something without noting it."""
    with restoring(session):
        session.state.param.update(**changed_only(session.state, choices))


@contextmanager
def restoring(session: Session) -> Iterator[None]:
    """Note no choices for a while."""
    session.restoring = True
    try:
        yield
    finally:
        session.restoring = False


def publish(session: Session) -> None:
    """Send the address, and whether undo and redo are possible, to the view if changed."""
    if session.state.rig is None:
        return
    text, step, panel = query(session), session.state.lesson_step, session.state.panel
    message = {
        "address": "?" + text,
        "link": "?" + (text if step is None or step.shows(panel) else OF_STEP.sub("", text)),
        "able": [session.history.can_undo, session.history.can_redo],
    }
    if {name: session.view.last_sent(name) for name in message} != message:
        session.view.send(**message)


def query(session: Session, always_camera: bool = False) -> str:
    """Return what the address says now; the camera is left out where it is the first one."""
    view, camera = session.view, None
    if view.camera is not None and (always_camera or not view.at_home):
        camera = [*view.camera.position, *view.camera.focal_point]
    try:
        edits = session.edits_file.text_of(session.state.edits, session.state.opening)
    except (CutcellError, OSError) as error:
        session.fail(error)
        edits = ""
    return to_query(session.state, session.uploads.key, camera, edits)


def _chosen(session: Session) -> None:
    if session.state.rig is not None and not session.restoring:
        session.history.note(_now(session), time.monotonic())
        publish(session)


def _now(session: Session) -> dict[str, Any]:
    state = session.state
    result = {name: getattr(state, name) for name in RESULT}
    return {**snapshot(state), **result, "character": session.character}
