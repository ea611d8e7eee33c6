"""From the state to what is seen: pure functions, one a panel, tested without a browser."""

from __future__ import annotations

from collections.abc import Callable

from viewers.description import Description

from ..state import State
from .common import plain
from .compare import compare
from .geodesics import geodesics
from .graph import graph
from .memo import Memo
from .pose import pose
from .weights import weights

__all__ = ["SCENES", "Memo", "resolve"]

SCENES: dict[str, Callable[[State, Memo], Description]] = {
    "graph": graph,
    "geodesics": geodesics,
    "weights": weights,
    "pose": pose,
    "compare": compare,
    "learn": weights,
}
"""The scene of each panel, for a state with a rig."""


def resolve(state: State, memo: Memo | None = None) -> Description:
    """Return the scene that a state stands for.

    Parameters
    ----------
    state : State
    memo : Memo, optional
        Speeds up a series of calls; changes nothing in what comes out.
    """
    if state.rig is None:
        return Description()
    return SCENES.get(state.panel, plain)(state, memo or Memo())
