"""Learn: the list of the lesson's steps."""

from functools import partial
from typing import Any

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from .steps import go

HINT = "Each step asks first. Answer, then look around and change anything."
OWN = "For your own lesson, press Add this view as a step over the canvas. Edit the saved files."


def _begin(session: Session) -> None:
    go(session, max(session.state.step, 0))


def _label(state: State) -> str:
    return "Start the lesson" if state.step < 0 else "Continue"


def _rows(state: State) -> list[Any]:
    return [
        ui.button(f"{index + 1}. {step.title}", partial(go, index=index), **ui.LINE)
        for index, step in enumerate(state.lesson.steps)
    ]


CONTROLS = ui.column(
    ui.intro(lambda state: f"How skin follows bones, in {len(state.lesson)} questions."),
    ui.section(
        "",
        ui.caption(HINT),
        ui.button(_label, _begin, icon="school", variant="contained"),
        ui.listed(_rows),
        top=4,
    ),
    ui.caption(OWN),
)
