"""Choices that are numbers in the text of the lesson and can be dragged; see `sentence.js`."""

from __future__ import annotations

import re
from typing import Any

from ...document.session import Session
from ...document.state import State
from ...looks.measures import RESOLUTIONS as COMPARED

RESOLUTIONS = [(n, str(n)) for n in (8, 12, 16, 20, 24, 32, 40, 48, 64, 96, 128)]
HUNDREDTHS = [(n / 100, f"{n / 100:g}") for n in range(101)]

SLIDERS: dict[str, tuple[str, list[tuple[Any, str]]]] = {
    "resolution": ("Resolution R", RESOLUTIONS),
    "graph_resolution": ("Resolution R", RESOLUTIONS),
    "beside_resolution": ("Resolution R", [(n, str(n)) for n in COMPARED]),
    "alpha": ("Smoothness α", HUNDREDTHS),
    "winding_threshold": ("Winding threshold τ", HUNDREDTHS[1:-1]),
    "connectivity": ("Connectivity", [(6, "6"), (26, "26"), ("any", "any angle")]),
}
"""Label and stops, each a value and its text, by the name of the choice."""

NAME = re.compile(r"\{(\w+)\}")


def sliders_of(state: State, text: str) -> dict[str, dict[str, Any]]:
    """Return the sliders that a text names, for `sentence.js`."""
    names = [name for name in NAME.findall(text) if name in SLIDERS]
    return {
        name: {"value": getattr(state, name), "label": SLIDERS[name][0], "stops": SLIDERS[name][1]}
        for name in names
    }


def slide(session: Session, name: str, value: Any) -> None:
    """Set a choice to the stop that a person dragged to; other values change nothing."""
    if name in SLIDERS and value in [stop for stop, _ in SLIDERS[name][1]]:
        setattr(session.state, name, value)
