"""Change the mask of the chosen layer: by the selection, over the surface, by another layer's."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.editing import Mask
from cutcell.editing.layers.layer import EVERYWHERE
from cutcell.errors import ParameterError

from ...document.selection import selected
from ...document.session import Session
from ...document.state import State
from ...looks.mask import chosen_layer, mask_strengths
from ...looks.selection import neighbours_of
from ..compute import stack
from .commands import set_layer

STEPS = 1000
"""Strengths are stored in as many steps from 0 to 1: files of layers stay short."""
NO_LAYER = "no layer is chosen; choose one under Layers to change its mask"

Strengths = NDArray[np.float64]


def put_mask(session: Session, strengths: Strengths) -> None:
    """Give the chosen layer a mask, shape (n,), in a step of undo; show it."""
    place = session.state.layer
    if place is None:  # nothing is chosen any longer
        return
    strengths = np.round(np.clip(strengths, 0, 1) * STEPS) / STEPS
    masked = np.flatnonzero(strengths)
    mask = EVERYWHERE
    if (strengths < 1).any():
        mask = Mask(vertices=masked, strengths=strengths[masked])
    session.state.weights_shown = "mask"  # first: undo takes the mask back before the colours
    session.history.part()
    set_layer(session, place, mask=mask)


def stroke_strengths(state: State, vertices: NDArray[np.intp]) -> Strengths | None:
    """Return how much of a stroke is seen at vertices, shapes (k,); None for all of it.

    Where strokes go into the chosen layer, its mask and opacity limit what is seen.
    """
    layer = stack.painted_layer(state.edits, state.layer)
    if layer is None or (layer.is_opaque and layer.mask.is_all):
        return None
    strengths = None if layer.mask.is_all else mask_strengths(state)
    return layer.opacity * (np.ones(len(vertices)) if strengths is None else strengths[vertices])


def _changes(change: Callable[[Session, Strengths], Strengths]) -> Callable[[Session], None]:
    """Return a command that changes the strengths of the chosen layer's mask."""

    def act(session: Session) -> None:
        strengths = mask_strengths(session.state)
        if strengths is None:
            session.fail(ParameterError(NO_LAYER))
            return
        try:
            changed = change(session, strengths)
        except ParameterError as error:
            session.fail(error)
            return
        put_mask(session, changed)

    return act


def _by_selection(change: Callable[[Strengths, NDArray[np.bool_], float], Any]) -> Any:
    """Return a command that changes them by the selected vertices and the amount."""

    def changed(session: Session, strengths: Strengths) -> Strengths:
        chosen = selected(session.state)
        if chosen is None:
            raise ParameterError("no vertices are selected; select some to change the mask there")
        return np.asarray(change(strengths, chosen, session.state.amount), float)

    return _changes(changed)


def _feathered(session: Session, strengths: Strengths) -> Strengths:
    smooth = neighbours_of(session.state).smooth
    return smooth(strengths[:, None], session.state.passes)[:, 0]


def _copy(session: Session) -> None:
    if chosen_layer(session.state) is None:
        session.fail(ParameterError(NO_LAYER))
        return
    session.state.copied_mask = session.state.rig.mesh, mask_strengths(session.state)


def _pasted(session: Session, strengths: Strengths) -> Strengths:
    mesh, copied = session.state.copied_mask or (None, strengths)
    if mesh is not session.state.rig.mesh:
        raise ParameterError("no mask of this mesh was copied; copy one of another layer first")
    return copied


MASKS: dict[str, Callable[[Session], None]] = {
    "Selection only": _by_selection(lambda now, chosen, amount: chosen),
    "Add the selection": _by_selection(lambda now, chosen, amount: np.maximum(now, chosen)),
    "Remove the selection": _by_selection(lambda now, chosen, amount: np.where(chosen, 0, now)),
    "Fill the selection with amount": _by_selection(
        lambda now, chosen, amount: np.where(chosen, amount, now)
    ),
    "Grow": _changes(lambda session, now: neighbours_of(session.state).dilated(now)),
    "Shrink": _changes(lambda session, now: 1 - neighbours_of(session.state).dilated(1 - now)),
    "Feather": _changes(_feathered),
    "Invert": _changes(lambda session, now: 1 - now),
    "Everywhere": _changes(lambda session, now: np.ones_like(now)),
    "Copy mask": _copy,
    "Paste mask": _changes(_pasted),
}
"""By their names in the menu."""
