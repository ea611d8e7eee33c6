"""The present document in the history, and the address of it."""

import re
import time
from typing import Any

from cutcell.errors import CutcellError

from ..server.protocol.sent import ToBrowser
from .address import NOTED, simple, snapshot, to_query
from .document import Document, put
from .session import Session

OF_STEP = re.compile(r"&(?:step|answer|stage)=[^&]*")


def watch(session: Session) -> None:
    """Keep the address and the history up to what is chosen."""
    state = session.state
    noted = [*simple(state), *NOTED, "own", "repair", "edits"]
    state.param.watch(lambda *events: _chosen(session), noted)
    state.param.watch(lambda *events: publish(session), ["step", "answers", "staged", "vertex"])
    session.view.on_camera = lambda: publish(session)


def present(session: Session) -> Document:
    """Return the document that is open."""
    state = session.state
    return Document(
        session.source, state.own, state.rig, state.repair, state.edits, snapshot(state)
    )


def restore(session: Session, document: Document) -> None:
    """Choose again what was chosen once of the open character; it is no step."""
    state = session.state
    values: dict[str, Any] = {"repair": document.repair, "edits": document.edits}
    if document.rig is not None and document.own is state.own:
        values["rig"] = document.rig
        if document.rig.mesh is not state.rig.mesh:
            values |= {"vertex": None, "message": None}
    with session.history.restoring():
        put(state, **values, **document.choices)
    publish(session)


def publish(session: Session, again: bool = False) -> None:
    """Send the address, and whether undo and redo are possible, to the view if changed.

    They are sent `again` where the browser may show another address.
    """
    if session.state.rig is None:
        return
    text, step, panel = query(session), session.state.lesson_step, session.state.panel
    message: ToBrowser = {
        "address": "?" + text,
        "link": "?" + (text if step is None or step.shows(panel) else OF_STEP.sub("", text)),
        "able": [session.history.can_undo, session.history.can_redo],
    }
    if again or {name: session.view.last_sent(name) for name in message} != message:
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
    if session.state.rig is not None and not session.history.is_restoring:
        session.history.note(present(session), time.monotonic())
        publish(session)
