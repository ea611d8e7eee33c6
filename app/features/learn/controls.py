"""Learn: the list of the lesson's steps, and the present view as a new step."""

import re
from functools import partial
from typing import Any

from ...document.recording import query
from ...document.session import Session
from ...widgets import controls as ui
from .lesson import Answer, Step, written
from .steps import go

HINT = "Each step asks first. Answer, then look around and change anything."
OWN = "Save the present view as a file. Edit its texts, and open it with cutcell app --lesson."
DROPPED = re.compile(r"(?:^|&)(?:step|answer|stage|rig=~)[^&]*")
"""Entries of an address that no step needs; an uploaded character will not be there."""


def _begin(session: Session) -> None:
    go(session, max(session.state.step, 0))


def _label(state: Any) -> str:
    return "Start the lesson" if state.step < 0 else "Continue"


def this_view(session: Session) -> Step:
    """Return the present view as a step of a lesson."""
    state = session.state
    address = DROPPED.sub("", query(session)).lstrip("&")
    plays = "&playing=1" if state.playing or state.animating else ""
    return Step(
        title="New step",
        question="What do you expect?",
        address=address + plays,
        answer=Answer("choice", options=["Yes", "No"], expected="Yes"),
        text="Explain what the picture shows.",
        sentence="One sentence that remains.",
    )


def _save(session: Session) -> None:
    session.view.offer("01-new-step.md", written(this_view(session)).encode())


def _rows(state: Any) -> list[Any]:
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
    ui.folded(
        "Your own lesson",
        ui.caption(OWN),
        ui.button("Add this view as a step", _save, icon="add"),
        visible=lambda state: state.rig is not None,
    ),
)
