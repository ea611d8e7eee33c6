"""Weights that follow the falloff at once: the distances stay.

A falloff is worked out once for many influences; how many are kept is decided after.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from cutcell.errors import CutcellError
from cutcell.geodesics import BoneDistances
from cutcell.progress import Progress
from cutcell.skinning import Binding, keep_strongest, skinning_weights

from ..state.method import GRAPH, WEIGHTS, method_of
from ..state.weights import MOST

if TYPE_CHECKING:
    from ..session import Session

QUICK = ("paper",)
"""Falloffs that need no thread of their own."""


def watch(session: Session) -> None:
    """Keep the weights up to the falloff that is chosen."""
    session.state.param.watch(lambda *events: weigh(session), list(WEIGHTS))


def generous(session: Session) -> dict[str, Any]:
    """Return what to bind with, so that fewer influences can be kept later."""
    method = method_of(session.state, (*GRAPH, *WEIGHTS))
    return {**method, "max_influences": MOST, "threshold": 0.0}


def bound(session: Session, binding: Binding, method: dict[str, Any]) -> Binding:
    """Take in what was bound generously; return it with the weights that are chosen."""
    session.falloffs = {}
    _keep(session, binding.distances, method["falloff"], method["alpha"], binding.weights)
    pruned = keep_strongest(binding.distances, binding.weights, *_kept(session).values())
    return replace(binding, weights=pruned)


def weigh(session: Session) -> None:
    """Turn the distances that are there into weights again."""
    state = session.state
    if state.binding is None:
        return
    distances, allowed = state.binding.distances, state.rig.allowed
    falloff, alpha = state.falloff, state.alpha

    def work(progress: Progress) -> NDArray:
        progress("weights", 0.0)
        return skinning_weights(
            distances, falloff=falloff, alpha=alpha, max_influences=MOST, allowed=allowed
        )

    def done(weights: NDArray) -> None:
        _keep(session, distances, falloff, alpha, weights)
        weigh(session)

    known = session.falloffs.get(falloff)
    if known is not None and known[0] is distances and (known[1] == alpha or falloff != "paper"):
        pruned = keep_strongest(distances, known[2], *_kept(session).values())
        state.binding = replace(state.binding, weights=pruned)
    elif falloff in QUICK:
        try:
            done(work(lambda stage, fraction: None))
        except CutcellError as error:
            session.fail(error)
    else:
        session.start(work, done)


def _kept(session: Session) -> dict[str, Any]:
    return method_of(session.state, ("max_influences", "threshold"))


def _keep(
    session: Session, distances: BoneDistances, falloff: str, alpha: float, weights: NDArray
) -> None:
    session.falloffs[falloff] = (distances, alpha, weights)
