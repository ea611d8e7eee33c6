"""The flat scene over the canvas: one plane of the lattice, drawn and searched in the browser."""

from functools import partial
from typing import Any

import param

from cutcell_viewers.palette import BONE_IDLE, GHOST, INTERIOR, MARK, SOURCE, colormap, to_hex

from ...document.framing import theme_of
from ...document.session import Session
from ...document.state import State
from ...server.protocol.received import Answer, Message
from ...widgets.modules import Widget, script
from ...widgets.table import Control, draw

STEPS = 16
"""Colours of distances. Between them lie the map's lines of equal distance."""
WINDINGS = 11
"""Colours of winding numbers from 0 to 1."""


class FlatScene(Widget):
    """Draws a section of the character over the canvas; hidden without a mode."""

    value = param.String("", doc="One of `features.flat.choices.MODES`.")
    data = param.String("", doc="What `FlatSection.data` returns, as JSON.")
    tau = param.Number(0.5, doc="Winding threshold.")
    colors = param.Dict({}, doc="What `flat_colors` returns.")
    task = param.String("", doc="See `lesson_task` of the state.")

    _esm = script("flat/scene")

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(**params)
        self._session = session

    def receive(self, message: Message) -> None:
        """Take the answer to a step that asks to act in the flat scene."""
        if isinstance(message, Answer) and self._session.state.lesson_task == "open":
            self._session.state.acted = message.value


def flat_colors(state: State) -> dict[str, Any]:
    """Return the colours of the flat scene as CSS has them."""
    theme = theme_of(state)

    def sampled(name: str, at: Any) -> list[str]:
        table = colormap(name) / 255
        return [to_hex(table[round(part * (len(table) - 1))]) for part in at]

    return {
        "mesh": to_hex(theme.mesh_edge),
        "interior": to_hex(INTERIOR),
        "surface": to_hex(theme.surface_edge),
        "ink": to_hex(theme.ink),
        "paper": to_hex(theme.top),
        "idle": to_hex(BONE_IDLE),
        "negative": to_hex(GHOST),
        "mark": to_hex(MARK),
        "source": to_hex(SOURCE),
        "distance": sampled("distance", [(k + 0.5) / STEPS for k in range(STEPS)]),
        "winding": sampled("winding", [k / (WINDINGS - 1) for k in range(WINDINGS)]),
    }


def overlay(session: Session) -> FlatScene:
    """Return the flat scene of a session, in its place over the canvas."""
    row = Control(
        partial(FlatScene, session),
        act=lambda session, value: session.state.param.update(flat=value),
        value=lambda state: state.flat,
        data=lambda state: state.flat_data or "",
        tau=lambda state: state.winding_threshold,
        colors=flat_colors,
        task=lambda state: state.lesson_task,
        margin=0,
    )
    scene: FlatScene = draw(session, row)
    return scene
