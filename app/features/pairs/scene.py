"""The two characters of a pair side by side, each as large as the box that the camera sees."""

from dataclasses import replace

import numpy as np

from cutcell.rig import Rig
from cutcell.runtime.display import shown_name
from cutcell_viewers.character import body, bones, to_scene
from cutcell_viewers.description import Actor, Description
from cutcell_viewers.weights_scene import weight_colors

from ...document.framing import bounds_of
from ...document.state import State
from ...looks.character import plain


def scene(state: State) -> Description:
    """Return the scene of the panel Pairs."""
    pair = state.chosen_pair
    if pair is None:
        return plain(state)
    audit = state.opened.audit
    captions = tuple(map(shown_name, (audit.names[pair.a], audit.others[pair.b])))
    if state.beside is None:
        return Description(views=captions)
    made = state.memo("pair", (state.beside, state.rig), lambda: side_by_side(state))
    rigs = {
        name: replace(actor, visible=state.skeleton) if actor.overlay else actor
        for name, actor in made.items()
    }
    return Description(rigs, views=captions)


def side_by_side(state: State) -> dict[str, Actor]:
    """Return both characters in the colours of their weights, one view each."""
    actors: dict[str, Actor] = {}
    for view, rig in enumerate(state.beside.rigs):
        placed = into_box(rig, bounds_of(state))
        style = {} if rig.weights is None else weight_colors(rig, rig.weights, None)[0]
        parts = {"pair": body(placed, **style), **bones(placed)}
        for name, actor in parts.items():
            actors[f"{name} of {'AB'[view]}"] = replace(actor, view=view, skin=None)
    return actors


def into_box(rig: Rig, box: np.ndarray) -> Rig:
    """Move a character to the middle of a box (2, 3), as large as its longest side.

    The audit compares characters in this way, in a cube of side 1.
    """
    points = to_scene(rig, rig.mesh.vertices[rig.mesh.used])
    low, high = points.min(axis=0), points.max(axis=0)
    scale = np.ptp(box, axis=0).max() / max(float((high - low).max()), 1e-300)
    move = np.eye(4) * [scale, scale, scale, 1]
    move[:3, 3] = box.mean(axis=0) - scale * (low + high) / 2
    return replace(rig, world=move @ rig.world)
