"""From the state to what is seen: pure functions, one a panel, tested without a browser."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module

from cutcell_viewers.description import Actor, Description, Legend
from cutcell_viewers.palette import ATTACHMENT, MARK, SOURCE
from cutcell_viewers.skin import skin_of_weights

from ..state import PANELS, State
from .memo import Memo

__all__ = ["SCENES", "Memo", "following", "resolve"]

SCENES: dict[str, Callable[[State, Memo], Description]] = {
    panel: getattr(import_module(f".{panel}", __name__), panel) for panel in PANELS
}
"""The scene of each panel, for a state with a rig."""

RIGID = "parts fixed to one bone"
"""Legend of the grey parts of a coloured body."""


def resolve(state: State, memo: Memo | None = None) -> Description:
    """Return the scene of a state.

    Parameters
    ----------
    state : State
    memo : Memo, optional
        Speeds up a series of calls; does not change the result.
    """
    if state.rig is None:
        return Description()
    panel = state.panel if state.is_panel_usable else "graph"
    scene = SCENES[panel]
    whole = scene(state, memo or Memo())
    whole = replace(whole, actors={**whole.actors, **state.actors})
    if whole.legend is None or not (_coloured(whole.actors) and state.rig.attachments):
        return whole
    swatches = (*whole.legend.swatches, (ATTACHMENT, RIGID))
    return replace(whole, legend=replace(whole.legend, swatches=swatches))


def following(state: State, memo: Memo | None = None) -> Description:
    """Return the scene of a state during a motion.

    The body follows the joints on every panel, by the weights that are held; what cannot follow
    would be left behind, and is left out. Nothing is then inside for which the body would have to
    be hidden or see-through.

    Parameters
    ----------
    state : State
        With weights.
    memo : Memo, optional
        As in `resolve`.
    """
    memo = memo or Memo()
    whole = resolve(state, memo)
    actors = dict(whole.actors)
    bodies = [name for name in actors if name.startswith("body") and actors[name].skin is None]
    if bodies:
        # As `character` does where the body follows on any panel.
        inputs = (state.rig, state.weights)
        skin = memo("skin", inputs, lambda: skin_of_weights(state.weights))
        actors |= {name: replace(actors[name], skin=skin) for name in bodies}
    actors = {name: actor for name, actor in actors.items() if actor.skin is not None}
    if not PANELS[state.panel].poses:
        for name in actors:
            if name.startswith(("body", "attachment")):
                actors[name] = replace(actors[name], visible=True, opacity=1.0)
    return replace(whole, actors=actors, cut=None, legend=_left_of(whole.legend, actors))


def _left_of(legend: Legend | None, actors: dict[str, Actor]) -> Legend | None:
    """Return what a legend says of that which moves: nothing of edges, sources and ways."""
    if legend is None or not _coloured(actors):
        return None
    static = (MARK, SOURCE)
    return replace(legend, swatches=tuple(one for one in legend.swatches if one[0] not in static))


def _coloured(actors: dict[str, Actor]) -> bool:
    """Whether the body's colours tell something."""
    bodies = [actor for name, actor in actors.items() if name.startswith("body")]
    return any(body.colors is not None or body.scalars is not None for body in bodies)
