"""Compute graph, distances and weights of the character that stands there.

Weights follow the falloff at once, as the distances stay. A falloff that takes a while is worked
out once for many influences; how many are kept is decided after.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from numpy.typing import NDArray

import cutcell
from cutcell.errors import CutcellError
from cutcell.method import joints_needed
from cutcell.progress import Progress
from cutcell.rig import Rig
from cutcell.skinning import Binding, keep_strongest, skinning_weights

from ..state import State
from ..state.method import GRAPH, WEIGHTS, effective, method_of
from ..state.weights import MOST
from . import history
from .session import Session

QUICK = ("paper",)
"""Falloffs that are worked out again with every change, without a thread of their own."""


def watch(session: Session) -> None:
    """Keep graph and weights up to the method that is chosen."""
    watch, tasks = session.state.param.watch, session.tasks
    watch(lambda *events: tasks.after_a_pause(lambda: _rebind(session)), list(GRAPH))
    watch(lambda *events: weigh(session), list(WEIGHTS))


def bind(session: Session, message: tuple[str, str] | None = None) -> None:
    """Compute graph, distances and weights of the character that stands there.

    Parameters
    ----------
    session : Session
    message : (severity, sentence), optional
        What is still to be read when it is done.
    """
    state = session.state
    rig, method = state.rig, generous(state)
    if rig is None:
        return
    if state.bare:
        _build(session, message)
        return
    graph = session.bound_for = method_of(state, GRAPH)
    few = kept(state)

    def work(progress: Progress) -> Any:
        generous = cutcell.bind(rig, progress=progress, **effective(method))
        return generous, pruned(generous, few)

    def done(bindings: Any) -> None:
        session.built_for = graph
        generous, binding = bindings
        session.falloffs = {method["falloff"]: (generous.distances, generous.weights)}
        notice, session.notice = session.notice, ""
        told = ("info", notice) if notice and message is None else message
        state.param.update(binding=binding, field=None, message=told)
        if method_of(state, WEIGHTS) != {**{name: method[name] for name in WEIGHTS}, **few}:
            weigh(session)  # others were chosen in the meantime

    session.start(work, done, failed=lambda: _go_back(session, graph))


def cancel(session: Session) -> None:
    """Stop computing; what was there stays."""
    state = session.state
    if session.tasks.jobs("main").cancel():
        session.uploads.stay(session.uploads.key)
        state.param.update(busy=False, message=("info", "Cancelled. The page keeps what it had."))
        if state.graph is not None:
            _go_back(session, session.bound_for)


def swap(session: Session, rig: Rig, **more: Any) -> None:
    """Show the same character with other faces or weights, and bind it; all choices stay."""
    session.tasks.jobs("field").cancel()
    session.state.param.update(
        rig=rig, binding=None, bare_graph=None, field=None, vertex=None, message=None, **more
    )
    bind(session)


def restore(session: Session, choices: dict[str, Any]) -> None:
    """Choose again what was chosen once; the character that it was chosen of is bound again."""
    state, rig = session.state, choices.get("rig", session.state.rig)
    history.restore(session, history.plain(choices))
    if rig is not state.rig:
        with history.restoring(session):
            swap(session, rig, repair=choices["repair"])
    history.tell(session)


def _build(session: Session, message: tuple[str, str] | None) -> None:
    """Build the graph of a mesh without a skeleton."""
    rig = session.state.rig
    wanted = session.bound_for = method_of(session.state, GRAPH)
    chosen = {name: value for name, value in wanted.items() if name != "leaf"}

    def done(graph: Any) -> None:
        session.built_for = wanted
        session.state.param.update(bare_graph=graph, message=message)

    session.start(
        lambda progress: cutcell.build_graph(rig.mesh, progress=progress, **chosen),
        done,
        failed=lambda: _go_back(session, wanted),
    )


def _go_back(session: Session, graph: dict[str, Any]) -> None:
    """Choose what the page holds instead of what no graph came of; at first, the defaults."""
    state = session.state
    held = session.built_for if state.graph is not None else method_of(State(), GRAPH)
    if method_of(state, GRAPH) != graph or graph == held:
        return
    session.bound_for = held
    history.withdraw(session, held)
    if state.graph is None:
        bind(session, state.message)


def _rebind(session: Session) -> None:
    """Compute again if the graph's parameters are others than those last computed for."""
    if method_of(session.state, GRAPH) != session.bound_for:
        bind(session)


# Weights of the distances that are there


def generous(state: State) -> dict[str, Any]:
    """Return what to bind with, so that fewer influences can be kept later."""
    return {**method_of(state, (*GRAPH, *WEIGHTS)), "max_influences": MOST, "threshold": 0.0}


def kept(state: State) -> dict[str, Any]:
    """Return which of many influences are chosen."""
    return method_of(state, ("max_influences", "threshold"))


def pruned(binding: Binding, kept: dict[str, Any]) -> Binding:
    """Return what was bound generously with the weights that are chosen."""
    return replace(binding, weights=keep_strongest(binding.distances, binding.weights, **kept))


def weigh(session: Session) -> None:
    """Turn the distances that are there into weights again."""
    state = session.state
    if state.binding is None:
        return
    distances, falloff, few = state.binding.distances, state.falloff, kept(state)
    chosen = effective({"falloff": falloff, "alpha": state.alpha})
    make = partial(skinning_weights, distances, **chosen, allowed=state.rig.allowed)
    known = session.falloffs.get(falloff)
    if not _measured(distances, falloff, few["max_influences"]):
        bind(session)
    elif falloff in QUICK:
        _soon(session, partial(make, **few))
    elif known is not None and known[0] is distances:
        _soon(session, partial(keep_strongest, distances, known[1], **few))
    else:

        def work(progress: Progress) -> NDArray:
            progress("weights", 0.0)
            return make(max_influences=MOST)

        def done(weights: NDArray) -> None:
            session.falloffs[falloff] = (distances, weights)
            weigh(session)

        session.start(work, done)


def _measured(distances: Any, falloff: Any, most: int) -> bool:
    """Whether distances are known from as many joints as a falloff needs."""
    known, needed = distances.nearest_joints, joints_needed(falloff, most)
    return known is None or (needed is not None and needed <= known)


def _soon(session: Session, make: Callable[[], NDArray]) -> None:
    """Show weights that are made in a moment; those of a large character, when they are there."""
    binding = session.state.binding

    def show(weights: NDArray) -> None:
        now = session.state.binding
        if now is not None and now.distances is binding.distances:
            session.state.binding = replace(now, weights=weights)

    newest = session.tasks.newest("weights")
    if not session.state.quick:
        newest.do(lambda progress: make(), show)
        return
    newest.cancel()
    try:
        show(make())
    except CutcellError as error:
        session.fail(error)
