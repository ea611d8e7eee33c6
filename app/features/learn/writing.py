"""The present view as a new step of a lesson, and steps as text."""

import re
from dataclasses import fields

import yaml

from ...document.recording import query
from ...document.session import Session
from .lesson import Answer, Step

DROPPED = re.compile(r"(?:^|&)(?:step|answer|stage|camera|rig=~)[^&]*")
"""Entries of an address that no step needs; an uploaded character will not be there."""


def save_view(session: Session) -> None:
    """Send the present view to the browser as the file of a step."""
    if session.state.rig is not None:
        session.view.offer("01-new-step.md", written(this_view(session)).encode())


def this_view(session: Session) -> Step:
    """Return the present view as a step of a lesson."""
    state, camera = session.state, session.view.camera
    address = DROPPED.sub("", query(session)).lstrip("&")
    if camera is not None:
        numbers = (*camera.position, *camera.focal_point)
        address += f"&camera={','.join(f'{x:.4g}' for x in numbers)}"
    if state.playing or state.animating:
        address += "&playing=1"
    return Step(
        title="New step",
        question="What do you expect?",
        address=address,
        answer=Answer("choice", options=["Yes", "No"], expected="Yes"),
        text="Explain what the picture shows.",
        sentence="One sentence that remains.",
    )


def written(step: Step) -> str:
    """Return the text of the file that `lesson.read` reads as a step."""
    head = {f.name: getattr(step, f.name) for f in fields(Step) if f.name not in ("text", "answer")}
    plain = vars(Answer(step.answer.kind))
    answer = {n: v for n, v in vars(step.answer).items() if n == "kind" or v != plain[n]}
    front = {name: value for name, value in head.items() if value}
    front["answer"] = answer
    text = yaml.safe_dump(front, sort_keys=False, allow_unicode=True, width=100)
    return f"---\n{text}---\n{step.text}\n"
