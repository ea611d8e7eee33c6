"""Explain the weights of the chosen vertex, where that is asked for."""

from typing import Any

import cutcell
from cutcell.runtime.progress import Progress

from ..scenes.explain import explanation_of
from .session import Session


def watch(session: Session) -> None:
    """Keep the explanation up to the vertex that is chosen."""
    session.state.param.watch(lambda *events: explain(session), ["vertex", "binding", "explain"])


def explain(session: Session) -> None:
    """Explain the chosen vertex, unless that is done."""
    state, newest = session.state, session.tasks.newest("explain")
    rig, binding, vertex = state.rig, state.binding, state.vertex
    if not state.explain or binding is None or vertex is None:
        newest.cancel()
        return
    if explanation_of(state) is not None:
        return
    bound = session.binder.bound
    corrections = state.corrections if bound is None else bound.corrections

    def work(progress: Progress) -> Any:
        distances = binding.distances
        return cutcell.explain(
            rig,
            vertex,
            distances=distances,
            corrections=corrections,
            progress=progress,
            method=binding.method,
        )

    def done(result: Any) -> None:
        state.explanation = (binding, result)

    newest.do(work, done)
