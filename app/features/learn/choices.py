"""Choices of the panel Learn."""

from typing import Any

import param

from ...document.common import MOMENT
from ...document.state import Panel
from .lesson import Step, built_in

PANEL = Panel(
    "Learn",
    '<path d="M2.5 9.5L12 5l9.5 4.5L12 14z"/>'
    '<path d="M6.5 11.5v5c3 2.6 8 2.6 11 0v-5M21.5 9.5v6"/>',
    works_without_skeleton=True,
    is_rendered=False,
)


class Choices(param.Parameterized):
    """The lesson, its step, and the answers so far."""

    lesson: Any = param.Parameter(built_in(), doc="A `Lesson`.")
    step = param.Integer(-1, doc="The step that is shown; -1 for none.", precedence=MOMENT)
    answers = param.Dict({}, doc="Answers by step; a step without one is not revealed.")
    acted: Any = param.Parameter(None, doc="The answer by an act in the picture.")
    staged = param.Boolean(
        False, doc="Whether the lesson is presented, without the sidebar.", precedence=MOMENT
    )

    @property
    def lesson_step(self) -> Step | None:
        """The step that is shown, or None."""
        return self.lesson[self.step] if 0 <= self.step < len(self.lesson) else None

    @property
    def lesson_task(self) -> str:
        """Whether an act in the picture that the step asks for is "open" or "done"; else ""."""
        step = self.lesson_step
        if step is None or step.answer.kind != "act":
            return ""
        return "done" if self.step in self.answers else "open"
