"""Return to choices that could be computed, after a failure or when a person cancels."""

from typing import Any

from cutcell.editing import Edits, edited_rig

from ...document import recording
from ...document.edits import changes
from ...document.method import GRAPH, WEIGHTS, default, method_of
from ...document.session import Session

CHAIN = ("built_graph", "bound", "influences", "recomputed", "binding")
"""Results that follow each other from a character to its weights."""


def watch(session: Session) -> None:
    """Remember the choices of which everything was computed, and what is still to be read."""
    follow = session.state.param.watch
    follow(lambda *events: _arrived(session), ["binding", "built_graph"])
    follow(lambda *events: _changed(session), ["rig", "edits", *GRAPH])


def is_current(session: Session) -> bool:
    """Return whether the weights, or the graph of a bare mesh, follow all that is chosen."""
    return session.engine.is_fresh("binding")


def is_pending(session: Session) -> bool:
    """Return whether weights are computed, or are about to be."""
    return session.engine.is_pending("binding")


def cancel(session: Session) -> None:
    """Stop computing; what was there stays."""
    state, waiting = session.state, bool(session.exports)
    exports = session.work.cancel("export") or waiting
    session.exports.clear()
    session.show_progress()
    loads = session.work.cancel("character")
    computes = session.engine.refuse(*CHAIN)
    if exports or loads or computes:
        text = "Cancelled. Nothing was changed." if loads or computes else "Cancelled."
        state.message = ("info", text + " Nothing was exported." * exports)
    if loads:
        session.uploads.stay(session.uploads.key)
    if computes and state.graph is not None:
        go_back(session)


def go_back(session: Session) -> None:
    """Choose what was computed instead of what cannot be; at first, the defaults."""
    session.drop_exports()
    state = session.state
    mesh, choices, edits = session.computed or (None, {}, Edits())
    if state.rig is None or mesh is not state.rig.mesh or state.graph is None:
        choices, edits = {name: default(name) for name in GRAPH}, state.first_edits
    if method_of(state, tuple(choices)) == choices and state.edits == edits:
        return
    if state.graph is None:
        session.notice = state.message
    changed = changes(state, edited_rig(state.own, edits), edits)
    recording.withdraw(session, {**choices, **changed})


def _arrived(session: Session) -> None:
    state = session.state
    if state.rig is None or not is_current(session):
        return
    choices: dict[str, Any] = method_of(state, (*GRAPH, *WEIGHTS))
    session.computed = state.rig.mesh, choices, state.edits
    notice, session.notice = session.notice, None
    if notice is not None:
        state.message = notice
    elif state.message is session.older_message:
        state.message = None


def _changed(session: Session) -> None:
    session.older_message = session.state.message
