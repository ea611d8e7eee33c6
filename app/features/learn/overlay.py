"""The card of the lesson, over the canvas, and the window of the speaker's notes."""

from functools import partial
from typing import Any

import param

from ...document.session import Session
from ...document.state import State
from ...server.protocol.received import Answer, ChooseValue, Message, Offer, ShowStep, Stage
from ...widgets.modules import Widget, script, style
from ...widgets.table import Control, draw
from .lesson import Lesson
from .plots import plot_of
from .steps import answer, choose, go, named_values, offer, painted_scores, pressed_offers


class LessonCard(Widget):
    """Shows a step of the lesson, and takes the answer."""

    steps = param.List([], doc="What `Step.to_json` returns, of each step.")
    now = param.Dict({}, doc="What the card shows: see `frontend/lesson/card.js`.")

    _esm = script("lesson/lesson")

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(**params)
        self._session = session

    def receive(self, message: Message) -> None:
        """Run the action of a message of the card."""
        session = self._session
        match message:
            case ShowStep(step):
                go(session, step)
            case Answer(value):
                answer(session, value)
            case Offer(index):
                offer(session, index)
            case ChooseValue(name, value):
                choose(session, name, value)
            case Stage(on):
                session.state.staged = on


class LessonNotes(Widget):
    """Shows the speaker's notes of the step that another window of this browser shows."""

    steps = param.List([], doc="What `Step.to_json` returns, of each step.")

    _esm = script("lesson/notes")


def overlay(session: Session) -> LessonCard:
    """Return the card of a session's lesson."""
    row = Control(
        partial(LessonCard, session),
        now=_now,
        steps=steps_of(session.state.lesson),
        stylesheets=[style("lesson/card_place")],
        css_classes=lambda state: ["staged"] if state.staged else [],
        margin=0,
    )
    card: LessonCard = draw(session, row)
    return card


def steps_of(lesson: Lesson) -> list[dict[str, Any]]:
    """Return a lesson as its scripts need it."""
    return [step.to_json() for step in lesson.steps]


def _now(state: State) -> dict[str, Any]:
    step = state.lesson_step
    has_plot = step is not None and step.plot and state.step in state.answers
    return {
        "step": state.step,
        "answers": {str(step): value for step, value in state.answers.items()},
        "pressed": pressed_offers(state),
        "values": named_values(state),
        "staged": state.staged,
        "scores": painted_scores(state),
        "plot": plot_of(state, step.plot) if has_plot else None,
    }
