"""Learn: the list of the tour's steps."""

from typing import Any

import panel_material_ui as pmui

from ..commands.session import Session
from ..commands.tour import go
from ..state.tour import TOUR
from .controls import GAP, LINE, button, caption, column, intro, section, when


def learn(session: Session) -> pmui.Column:
    """Return the controls of the panel Learn."""
    state = session.state

    def begin(event: Any) -> None:
        go(session, max(state.tour, 0))

    start = pmui.Button(
        label=when(lambda at: "Start the tour" if at < 0 else "Continue", state.param.tour),
        icon="school",
        size="small",
        margin=GAP,
        sizing_mode="stretch_width",
        on_click=begin,
    )
    hint = "Each step sets the scene. Look around and change anything."
    steps = [_entry(session, index) for index in range(len(TOUR))]
    return column(
        intro(f"How skin follows bones, in {len(TOUR)} short steps."),
        section("", caption(hint), start, *steps, margin=(4, 20, 4, 20)),
    )


def _entry(session: Session, index: int) -> pmui.Button:
    return button(
        f"{index + 1}. {TOUR[index].title}",
        lambda: go(session, index),
        **LINE,
    )
