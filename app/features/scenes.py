"""Scenes of the state: pure functions, one for each panel."""

from dataclasses import replace
from typing import Any

from cutcell_viewers.description import Actor, Description, Legend, with_colormap
from cutcell_viewers.palette import ATTACHMENT, MARK, SOURCE
from cutcell_viewers.skin import Skin

from ..document.state import State
from . import FEATURES
from .state import PANELS

RIGID = "parts fixed to one bone"
"""Legend of the grey parts of a coloured body."""


def resolve(state: State) -> Description:
    """Return the scene of a state."""
    if state.rig is None:
        return Description()
    panel = state.panel if state.is_panel_usable else "graph"
    whole = FEATURES[panel].scene(state)
    blending: Any = state.blending if PANELS[panel].poses else "linear"
    whole = with_colormap(whole, state.colormap)
    whole = replace(whole, actors={**whole.actors, **state.actors}, blending=blending)
    if whole.legend is None or not (_coloured(whole.actors) and state.rig.attachments):
        return whole
    swatches = (*whole.legend.swatches, (ATTACHMENT, RIGID))
    return replace(whole, legend=replace(whole.legend, swatches=swatches))


def following(state: State) -> Description:
    """Return the scene of a state with weights during a motion.

    The body follows the joints on every panel; actors that cannot follow are left out, and the body
    need not be transparent for them.
    """
    whole = resolve(state)
    actors = dict(whole.actors)
    bodies = [name for name in actors if name.startswith("body") and actors[name].skin is None]
    if bodies:
        # The same entry of the memo as in `character`.
        inputs = (state.rig, state.weights)
        skin = state.memo("skin", inputs, lambda: Skin.of_weights(state.weights))
        actors |= {name: replace(actors[name], skin=skin) for name in bodies}
    actors = {name: actor for name, actor in actors.items() if actor.skin is not None}
    if not state.open_panel.poses:
        for name in actors:
            if name.startswith(("body", "attachment")):
                actors[name] = replace(actors[name], visible=True, opacity=1.0)
    legend = _left_of(whole.legend, actors)
    return replace(whole, actors=actors, cut=None, legend=legend, blending=state.blending)


def _left_of(legend: Legend | None, actors: dict[str, Actor]) -> Legend | None:
    """Return a legend without edges, sources and paths, which do not move."""
    if legend is None or not _coloured(actors):
        return None
    static = (MARK, SOURCE)
    return replace(legend, swatches=tuple(one for one in legend.swatches if one[0] not in static))


def _coloured(actors: dict[str, Actor]) -> bool:
    """Return whether a body is coloured."""
    bodies = [actor for name, actor in actors.items() if name.startswith("body")]
    return any(body.colors is not None or body.scalars is not None for body in bodies)
