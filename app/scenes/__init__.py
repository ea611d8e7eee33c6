"""From the state to what is seen: pure functions, one a panel, tested without a browser."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from viewers.description import Description
from viewers.skin import skin_of_weights

from ..state import State
from .common import plain
from .compare import compare
from .geodesics import geodesics
from .graph import graph
from .memo import Memo
from .pose import pose
from .weights import weights

__all__ = ["SCENES", "Memo", "following", "resolve"]

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


def following(state: State, memo: Memo | None = None) -> Description:
    """Return the scene that a state stands for as it goes through a motion.

    The body follows the joints on every panel, by the weights that are held; what cannot follow
    would be left behind, and is left out.

    Parameters
    ----------
    state : State
        With weights.
    memo : Memo, optional
        As in `resolve`.
    """
    whole = resolve(state, memo)
    actors = dict(whole.actors)
    if "body" in actors and actors["body"].skin is None:
        actors["body"] = replace(actors["body"], skin=skin_of_weights(state.weights))
    actors = {name: actor for name, actor in actors.items() if actor.skin is not None}
    return replace(whole, actors=actors, cut=None)
