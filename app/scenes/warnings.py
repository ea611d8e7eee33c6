"""Warnings for a person, each with the finding of the check that locates it."""

from dataclasses import dataclass

from cutcell.diagnosis.finding import TITLES
from cutcell.geodesics import FALLBACK_REASONS

from ..state import State

DOORS = {
    "faces are inside out": "inverted-faces",
    FALLBACK_REASONS[1]: "unused-vertices",
    FALLBACK_REASONS[2]: "unreachable-vertices",
    "no lattice point lies inside": "no-interior",
    "sum to one": "unnormalised-weights",
    "without weight": "unweighted-vertices",
    "negative": "invalid-weights",
}
"""A part of each warning about elements of the mesh, and the code of what is found there."""


@dataclass(frozen=True)
class Door:
    """A warning, and where it leads.

    Parameters
    ----------
    text : str
        What a person is warned of.
    code : str
        The finding that shows its elements, and says what to do; empty where none does.
    """

    text: str
    code: str = ""

    @property
    def label(self) -> str:
        """The label of the button that leads there."""
        return f"Show: {TITLES[self.code].lower()}" if self.code else ""


def warnings(state: State) -> list[Door]:
    """Return what a person should know about the result."""
    if state.graph is None:
        return []
    texts = [*state.rig.warnings, *(state.binding.warnings if state.binding else ())]
    return [Door(text, _code(text)) for text in texts]


def _code(text: str) -> str:
    return next((code for part, code in DOORS.items() if part in text), "")
