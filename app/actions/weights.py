"""Weights that follow the falloff at once: the distances stay."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from cutcell.errors import CutcellError
from cutcell.skinning import skinning_weights

from ..state.method import WEIGHTS, method_of

if TYPE_CHECKING:
    from ..session import Session


def watch(session: Session) -> None:
    """Keep the weights up to the falloff that is chosen."""
    session.state.param.watch(lambda *events: weigh(session), list(WEIGHTS))


def weigh(session: Session) -> None:
    """Turn the distances that are there into weights again."""
    state = session.state
    if state.binding is None:
        return
    try:
        weights = skinning_weights(state.binding.distances, **method_of(state, WEIGHTS))
    except CutcellError as error:
        session.fail(error)
    else:
        state.binding = replace(state.binding, weights=weights)
