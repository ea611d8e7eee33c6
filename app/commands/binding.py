"""Compute graph, distances and weights of the open character.

Weights follow the falloff at once, as the distances stay. A falloff that takes a while is worked
out once for many influences; how many are kept is decided after.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from numpy.typing import NDArray
from scipy.sparse import csr_array

import cutcell
from cutcell.binding import Binding
from cutcell.editing.binding_warnings import binding_warnings
from cutcell.editing.correct import adjustments_of
from cutcell.editing.corrections import Corrections
from cutcell.errors import CutcellError
from cutcell.method import joints_needed
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell.weights import keep_strongest, skinning_weights
from cutcell_app.jobs.preview import Preview

from ..state import State
from ..state.bound import Bound
from ..state.corrections import applied, changes, measured, same_structure
from ..state.method import GRAPH, WEIGHTS, effective, method_of
from ..state.weights import MOST
from . import history
from .correct import finished
from .session import Session

OF_GRAPH = tuple(name for name in GRAPH if name != "leaf")
"""Choices that the graph depends on."""
QUICK = ("paper",)
"""Falloffs that are worked out again with every change, without a thread of their own."""


def watch(session: Session) -> None:
    """Keep graph and weights up to the method that is chosen."""
    watch, tasks = session.state.param.watch, session.tasks
    watch(lambda *events: tasks.after_a_pause(lambda: _rebind(session)), list(GRAPH))
    watch(lambda *events: weigh(session), list(WEIGHTS))
    watch(lambda *events: _correct(session), "corrections")


def bind(session: Session, message: tuple[str, str] | None = None) -> None:
    """Compute graph, distances and weights of the character that stands there.

    Parameters
    ----------
    session : Session
    message : (severity, sentence), optional
        What is still to be read when it is done.
    """
    state = session.state
    rig, method = state.rig, wide_options(state)
    if rig is None:
        return
    if state.bare:
        _build(session, message)
        return
    request, few, corrections = binding_request(state), prune_options(state), state.corrections
    graph = session.binder.request(request, rig.mesh, OF_GRAPH)
    work = binding_work(state, rig, corrections, graph)

    def done(result: tuple[csr_array, Binding]) -> None:
        many, binding = result
        falloff = method["falloff"]
        cached = {falloff: (binding.distances, many)}
        cutoff = reach_of(falloff)
        notice = session.binder.arrived(
            Bound(rig.mesh, request, corrections, binding.graph, cutoff, cached)
        )
        notice_shown = ("info", notice) if notice and message is None else message
        state.param.update(binding=binding, field=None, message=notice_shown)
        chosen = {**{name: method[name] for name in WEIGHTS}, **few}
        if method_of(state, WEIGHTS) != chosen or state.corrections != corrections:
            weigh(session)  # others were chosen in the meantime

    session.start(work, done, failed=lambda: _failed(session, request))


def is_current(session: Session) -> bool:
    """Return whether the weights, or the graph of a bare mesh, follow all that is chosen."""
    state, bound, binding = session.state, session.binder.bound, session.state.binding
    if state.rig is None or bound is None or bound.mesh is not state.rig.mesh:
        return False
    if bound.request != binding_request(state) or bound.corrections != state.corrections:
        return False
    if state.bare:
        return state.bare_graph is not None
    return binding is not None and options_of(binding) == effective(method_of(state, WEIGHTS))


def is_pending(session: Session) -> bool:
    """Return whether weights are computed, or are about to be."""
    tasks = session.tasks
    return tasks.jobs("main").running or tasks.jobs("weights").running or tasks.is_due("choice")


def options_of(binding: Binding) -> dict[str, Any]:
    """Return the options that turned a binding's distances into weights."""
    return effective({name: getattr(binding.method, name) for name in WEIGHTS})


def resume(session: Session) -> None:
    """Compute weights that other work, which failed, has stopped."""
    if session.state.rig is not None and not is_current(session):
        bind(session, session.state.message)


def binding_work(
    state: State, rig: Rig, corrections: Corrections, graph: Any
) -> Callable[[Progress], tuple[csr_array, Binding]]:
    """Return what binds as is chosen now.

    It returns the weights of many influences, and the binding with those that are kept.
    """
    method, few = effective(wide_options(state)), prune_options(state)

    def work(progress: Progress) -> tuple[csr_array, Binding]:
        reusable = {"graph": graph, "corrections": measured(corrections)}
        result = cutcell.bind(rig, **reusable, progress=progress, **method)
        return csr_array(result.weights), prune(result, few, rig, corrections)

    return work


def previewer(state: State) -> Callable[[Rig, Corrections], Binding]:
    """Return what tells about how the rig that is bound is bound with joints elsewhere."""
    rig, binding, before = state.rig, state.binding, measured(state.corrections)
    method = cutcell.ANIMATION.with_options(
        **effective({**wide_options(state), **prune_options(state)})
    )
    most = state.max_influences
    made: list[Preview] = []

    def preview(moved: Rig, corrections: Corrections) -> Binding:
        if not made:
            made.append(Preview(rig, binding, method, before))
        result = made[0].bind(moved)
        weights = finished(moved, result.graph, result.weights, corrections, most)
        return replace(result, weights=weights)

    return preview


def reach_of(falloff: Any) -> float:
    """Return how many times as far as the nearest joint distances must be known."""
    return replace(cutcell.ANIMATION, falloff=falloff).reach_needed


def binding_request(state: State) -> dict[str, Any]:
    """Return what distances are measured for."""
    return {**method_of(state, GRAPH), "corrections": measured(state.corrections)}


def cancel(session: Session) -> None:
    """Stop computing; what was there stays."""
    state, waiting = session.state, bool(session.exports)
    exports = session.tasks.jobs("export").cancel() or waiting
    computes = session.tasks.jobs("main").cancel()
    session.exports.clear()
    session.ended("export")
    session.ended("main")
    if exports or computes:
        text = "Cancelled. Nothing was changed." if computes else "Cancelled."
        state.message = ("info", text + " Nothing was exported." * exports)
    if computes:
        session.uploads.stay(session.uploads.key)
        if state.graph is not None:
            _go_back(session, session.binder.requested)


def swap(session: Session, rig: Rig, **more: Any) -> None:
    """Show the same character with other faces or weights, and bind it; all choices stay."""
    session.tasks.jobs("field").cancel()
    state = session.state
    if rig.origin is None:
        more = {"own": replace(rig, skeleton=state.own.skeleton, clips=state.own.clips), **more}
    else:  # whose weights went to other joints
        more = {"own": replace(state.own, mesh=rig.mesh), **more}
    state.param.update(
        rig=rig, binding=None, bare_graph=None, field=None, vertex=None, message=None, **more
    )
    bind(session)


def restore(session: Session, choices: dict[str, Any]) -> None:
    """Choose again what was chosen once; the character that it was chosen of is bound again."""
    state, plain = session.state, history.plain(choices)
    corrections = choices.get("corrections", state.corrections)
    file_rig = choices.get("own") or state.own
    rig = choices.get("rig") or applied(file_rig, corrections)
    if not same_structure(rig, state.rig):
        history.restore(session, {**changes(state, rig, corrections), **plain, "own": file_rig})
    elif rig.mesh is state.rig.mesh and rig.weights is state.rig.weights:
        history.restore(session, {**plain, "rig": rig, "own": file_rig})  # at most joints moved
    else:
        history.restore(session, plain)
        with history.restoring(session):
            swap(session, rig, repair=choices["repair"], own=file_rig)
    history.publish(session)


def _build(session: Session, message: tuple[str, str] | None) -> None:
    """Build the graph of a mesh without a skeleton."""
    rig = session.state.rig
    request = binding_request(session.state)
    chosen = {name: request[name] for name in OF_GRAPH}
    cached = session.binder.request(request, rig.mesh, OF_GRAPH)

    def work(progress: Progress) -> Any:
        return cached or cutcell.build_graph(rig.mesh, progress=progress, **chosen)

    def done(graph: Any) -> None:
        session.binder.arrived(Bound(rig.mesh, request, Corrections(), graph))
        session.state.param.update(bare_graph=graph, message=message)

    session.start(work, done, failed=lambda: _failed(session, request))


def _failed(session: Session, request: dict[str, Any]) -> None:
    """Drop the exports of what cannot be computed, and go back."""
    session.drop_exports()
    _go_back(session, request)


def _go_back(session: Session, failed: dict[str, Any]) -> None:
    """Choose what the page holds instead of what nothing came of; at first, the defaults."""
    state, bound = session.state, session.binder.bound
    request, corrections, options = binding_request(State()), Corrections(), {}
    if state.graph is not None and bound is not None:
        request, corrections = bound.request, bound.corrections
    if state.binding is not None:
        options = options_of(state.binding)
    same = state.corrections == corrections and method_of(state, tuple(options)) == options
    if binding_request(state) != failed or (failed == request and same):
        return
    session.binder.withdrawn(request)
    _withdraw(session, {**{name: request[name] for name in GRAPH}, **options}, corrections)
    if state.graph is None:
        bind(session, state.message)


def _withdraw(session: Session, choices: dict[str, Any], corrections: Corrections) -> None:
    """Choose something again, and the corrections that there were."""
    state = session.state
    changed = changes(state, applied(state.own, corrections), corrections)
    history.withdraw(session, {**choices, **changed})


def _rebind(session: Session) -> None:
    """Compute again if what is measured for is other than what was last computed for."""
    if binding_request(session.state) != session.binder.requested:
        bind(session)


def _correct(session: Session) -> None:
    """Follow the corrections."""
    state = session.state
    if state.rig is None:
        return
    is_ready = state.bare_graph if state.bare else state.binding
    if is_ready is None and not session.tasks.jobs("main").running:
        session.binder.withdrawn()  # it was dropped with the joints that it was of
    if binding_request(state) != session.binder.requested:
        session.tasks.after_a_pause(lambda: _rebind(session))
    elif not state.bare:
        weigh(session)


# Weights of the distances that are there


def wide_options(state: State) -> dict[str, Any]:
    """Return what to bind with, so that fewer influences can be kept later."""
    return {**method_of(state, (*GRAPH, *WEIGHTS)), "max_influences": MOST, "threshold": 0.0}


def prune_options(state: State) -> dict[str, Any]:
    """Return which of many influences are chosen."""
    return method_of(state, ("max_influences", "threshold"))


def prune(binding: Binding, options: dict[str, Any], rig: Rig, corrections: Corrections) -> Binding:
    """Return what was bound generously with the weights that are chosen and corrected."""
    weights = keep_strongest(binding.distances, binding.weights, **options)
    most = options["max_influences"]
    weights = finished(rig, binding.graph, weights, corrections, most)
    return _reweighted(binding, weights, rig, corrections, options)


def _reweighted(
    binding: Binding,
    weights: NDArray,
    rig: Rig,
    corrections: Corrections,
    options: dict[str, Any],
) -> Binding:
    """Return a binding with other weights, and the options of the method that they follow."""
    warnings = binding_warnings(rig, binding.distances, weights, corrections)
    method = binding.method.with_options(**{"leaf": binding.method.leaf, **options})
    return replace(binding, weights=weights, warnings=warnings, method=method)


def weigh(session: Session) -> None:
    """Turn the distances that are there into weights again."""
    state, bound = session.state, session.binder.bound
    if state.binding is None or bound is None:
        return
    if binding_request(state)["corrections"] != bound.request["corrections"]:
        return  # they are about to be measured
    distances, falloff, few = state.binding.distances, state.falloff, prune_options(state)
    key = falloff if state.refine == "none" else f"{falloff} {state.refine}"
    cached = bound.falloffs.get(key)
    if bound.cutoff < reach_of(falloff) or not _measured(distances, falloff, few["max_influences"]):
        bind(session)
    elif falloff in QUICK:
        _soon(session, partial(_weights, state.snapshot(), **few))
    elif cached is not None and cached[0] is distances:
        many = cached[1]
        _soon(session, lambda: keep_strongest(distances, many.toarray(), **few))
    else:
        now = state.snapshot()

        def work(progress: Progress) -> csr_array:
            progress("weights", 0.0)
            return csr_array(_weights(now, max_influences=MOST))

        def done(many: csr_array) -> None:
            bound.falloffs[key] = (distances, many)
            weigh(session)

        request = binding_request(state)
        session.start(work, done, failed=lambda: _failed(session, request))


def _weights(state: Any, **few: Any) -> NDArray:
    """Return the weights of the distances that are there, before they are corrected last."""
    rig, distances = state.rig, state.binding.distances
    return skinning_weights(
        distances,
        **effective({name: getattr(state, name) for name in ("falloff", "refine", "alpha")}),
        allowed=rig.allowed,
        adjustments=adjustments_of(rig, distances.graph, measured(state.corrections)),
        **few,
    )


def _measured(distances: Any, falloff: Any, most: int) -> bool:
    """Whether distances are known from as many joints as a falloff needs."""
    nearest, needed = distances.nearest_joints, joints_needed(falloff, most)
    return nearest is None or (needed is not None and needed <= nearest)


def _soon(session: Session, make: Callable[[], NDArray]) -> None:
    """Show weights that are made in a moment; those of a large character, when they are there."""
    state = session.state
    rig, binding, corrections = state.rig, state.binding, state.corrections
    most, options = state.max_influences, effective(method_of(state, WEIGHTS))

    def weights() -> NDArray | CutcellError:
        try:
            return finished(rig, binding.graph, make(), corrections, most)
        except CutcellError as error:
            return error

    def show(weights: NDArray | CutcellError) -> None:
        now, bound = state.binding, session.binder.bound
        if isinstance(weights, CutcellError):
            session.fail(weights)
            session.drop_exports()
            if bound is not None and state.corrections == corrections != bound.corrections:
                _withdraw(session, {}, bound.corrections)
        elif now is not None and now.distances is binding.distances:
            session.binder.reweighted(corrections)
            state.binding = _reweighted(now, weights, rig, corrections, options)

    newest = session.tasks.newest("weights")
    if not state.quick:
        newest.do(lambda progress: weights(), show)
        return
    newest.cancel()
    show(weights())
