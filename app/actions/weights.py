"""Weights that follow the falloff at once: the distances stay.

A falloff that takes a while is worked out once for many influences; how many are kept is decided
after.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from cutcell.errors import CutcellError
from cutcell.progress import Progress
from cutcell.skinning import Binding, keep_strongest, skinning_weights
from cutcell.skinning.weights import joints_needed

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


def kept(state: Any) -> dict[str, Any]:
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
    make = partial(
        skinning_weights, distances, falloff=falloff, alpha=state.alpha, allowed=state.rig.allowed
    )
    known = session.falloffs.get(falloff)
    if not _measured(distances, falloff, few["max_influences"]):
        session.bind()
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


def _measured(distances: Any, falloff: str, most: int) -> bool:
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

    if not session.state.quick:
        session.newest("weights").do(lambda progress: make(), show)
        return
    session.newest("weights").cancel()
    try:
        show(make())
    except CutcellError as error:
        session.fail(error)
