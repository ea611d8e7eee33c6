"""The present view as a new step of a lesson, and steps as text."""

import re

import yaml

from ...document.recording import query
from ...document.session import Session
from .lesson import Answer, Step

DROPPED = re.compile(r"(?:^|&)(?:step|answer|stage|rig=~)[^&]*")
"""Entries of an address that no step needs; an uploaded character will not be there."""


def save_view(session: Session) -> None:
    """Send the present view to the browser as the file of a step."""
    session.view.offer("01-new-step.md", written(this_view(session)).encode())


def this_view(session: Session) -> Step:
    """Return the present view as a step of a lesson."""
    address = DROPPED.sub("", query(session, always_camera=True)).lstrip("&")
    address += "&playing=1" if session.state.playing or session.state.animating else ""
    answer = Answer("choice", options=["Yes", "No"], expected="Yes")
    text, rest = "Explain what the picture shows.", "One sentence that remains."
    return Step("New step", "What do you expect?", address, answer, text=text, sentence=rest)


def written(step: Step) -> str:
    """Return the text of the file that `lesson.read` reads as a step."""
    plain = vars(Answer(""))
    front = {n: value for n, value in vars(step).items() if value and n not in ("text", "answer")}
    front["answer"] = {n: value for n, value in vars(step.answer).items() if value != plain[n]}
    text = yaml.safe_dump(front, sort_keys=False, allow_unicode=True, width=100)
    return f"---\n{text}---\n{step.text}\n"
