"""Buttons that put a layer over some vertices: computed, from the file, or half of it."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from .commands import recompute, take_from_file

HALF = 0.5

Vertices = Callable[[Any], NDArray[np.intp]]
"""Returns vertices, shape (k,), of a state."""


def recompute_button(vertices: Vertices) -> ui.Control:
    """Return a button that gives vertices the computed weights."""

    def act(session: Session) -> None:
        recompute(session, vertices(session.state))

    return ui.button("Recompute here", act, icon="refresh")


def file_button(vertices: Vertices) -> ui.Control:
    """Return a button that gives vertices the file's weights."""

    def act(session: Session) -> None:
        take_from_file(session, vertices(session.state))

    return ui.button("Take from file here", act, icon="history", visible=ui.has_weights)


def blend_button(vertices: Vertices) -> ui.Control:
    """Return a button that blends the weights of vertices with those that are not the base."""

    def act(session: Session) -> None:
        put = recompute if session.state.edits.base == "file" else take_from_file
        put(session, vertices(session.state), HALF, "Blend")

    def label(state: State) -> str:
        return "Blend with computed" if state.edits.base == "file" else "Blend with file"

    return ui.button(label, act, icon="opacity", visible=ui.has_weights)
