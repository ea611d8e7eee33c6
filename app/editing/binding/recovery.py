"""Return to choices that could be computed, after a failure or when a person cancels."""

from ...document import recording
from ...document.document import put
from ...document.method import GRAPH, WEIGHTS, default, effective
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
    tasks = session.tasks.cancel()
    computes = session.engine.refuse(*CHAIN)
    if exports or tasks or computes:
        text = "Cancelled. Nothing was changed." if tasks or computes else "Cancelled."
        state.message = ("info", text + " Nothing was exported." * exports)
    if computes and state.graph is not None:
        go_back(session)


def go_back(session: Session) -> None:
    """Return to the choices that were computed last; at first, to the defaults."""
    session.drop_exports()
    state = session.state
    before = session.computed
    if before is None or before.own is not state.own or state.graph is None:
        values = {**{name: default(name) for name in GRAPH}, "edits": state.first_edits}
    else:
        # Options that the falloff does not use stay as they are.
        choices = effective({n: before.choices[n] for n in (*GRAPH, *WEIGHTS)})
        values = {**choices, "edits": before.edits, "repair": before.repair}
    if all(getattr(state, name) == value for name, value in values.items()):
        return
    with session.history.restoring():
        put(state, **values)
    session.history.replace_current(recording.present(session))
    recording.publish(session)
    session.older_message = None  # the error stays


def _arrived(session: Session) -> None:
    state = session.state
    if state.rig is None or not is_current(session):
        return
    session.computed = recording.present(session)
    if state.message is session.older_message:
        state.message = None


def _changed(session: Session) -> None:
    session.older_message = session.state.message
