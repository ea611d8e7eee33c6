"""Warnings for a person, each with the finding of the check that locates it."""

from dataclasses import dataclass, replace

from cutcell.diagnosis import TITLES

from ..document.state import State
from ..features.check.choices import EXPORT

OF_WEIGHTS = ("stretched-surface",)
"""Findings of weights: those of a binding are checked in what an export contains."""


@dataclass(frozen=True)
class WarningLink:
    """A warning, and the finding that shows its elements as `Choices.finding` has it, or empty."""

    text: str
    code: str = ""

    @property
    def label(self) -> str:
        """The label of the button that leads there."""
        return f"Show: {TITLES[self.code.removeprefix(EXPORT)].lower()}" if self.code else ""


def warnings(state: State) -> list[WarningLink]:
    """Return the warnings about the character and its weights."""
    if state.graph is None:
        return []
    of_rig, of_binding = state.rig.warnings, state.binding.warnings if state.binding else ()
    links = [WarningLink(text, getattr(text, "code", "")) for text in (*of_rig, *of_binding)]
    return [
        replace(link, code=EXPORT + link.code) if link.code in OF_WEIGHTS else link
        for link in links
    ]
