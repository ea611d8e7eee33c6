"""Weights that follow the falloff at once: the distances stay.

A falloff that takes a while is worked out once for many influences; how many are kept is decided
after.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from cutcell.errors import CutcellError
from cutcell.progress import Progress
from cutcell.skinning import Binding, keep_strongest, skinning_weights

from ..state.method import GRAPH, WEIGHTS, method_of
from ..state.weights import MOST

if TYPE_CHECKING:
    from ..session import Session

QUICK = ("paper",)
"""Falloffs that are worked out again with every change, without a thread of their own."""


def watch(session: Session) -> None:
    """Keep the weights up to the falloff that is chosen."""
    session.state.param.watch(lambda *events: weigh(session), list(WEIGHTS))


def generous(session: Session) -> dict[str, Any]:
    """Return what to bind with, so that fewer influences can be kept later."""
    method = method_of(session.state, (*GRAPH, *WEIGHTS))
    return {**method, "max_influences": MOST, "threshold": 0.0}


def bound(session: Session, binding: Binding, method: dict[str, Any]) -> Binding:
    """Take in what was bound generously; return it with the weights that are chosen."""
    session.falloffs = {method["falloff"]: (binding.distances, binding.weights)}
    pruned = keep_strongest(binding.distances, binding.weights, **_kept(session))
    return replace(binding, weights=pruned)


def weigh(session: Session) -> None:
    """Turn the distances that are there into weights again."""
    state = session.state
    if state.binding is None:
        return
    distances, falloff, kept = state.binding.distances, state.falloff, _kept(session)
    make = partial(
        skinning_weights, distances, falloff=falloff, alpha=state.alpha, allowed=state.rig.allowed
    )
    known = session.falloffs.get(falloff)
    if falloff in QUICK:
        try:
            _show(session, make(**kept))
        except CutcellError as error:
            session.fail(error)
    elif known is not None and known[0] is distances:
        _show(session, keep_strongest(distances, known[1], **kept))
    else:

        def work(progress: Progress) -> NDArray:
            progress("weights", 0.0)
            return make(max_influences=MOST)

        def done(weights: NDArray) -> None:
            session.falloffs[falloff] = (distances, weights)
            weigh(session)

        session.start(work, done)


def _show(session: Session, weights: NDArray) -> None:
    session.state.binding = replace(session.state.binding, weights=weights)


def _kept(session: Session) -> dict[str, Any]:
    return method_of(session.state, ("max_influences", "threshold"))
