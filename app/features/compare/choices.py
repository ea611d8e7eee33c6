"""Choices of the panel Compare."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import param

from cutcell_lab.baselines import METHODS

from ..lab.choices import OPTIONS
from ..panel import Panel
from .settings import is_settings

NOW = "now"
"""Stands among the methods for what the page computed, as it is set."""

FEWEST_VIEWS = 2
MAX_VIEWS = 4
SINGLE = ("minus", "first_method", "second_method")
"""Choices that are one of the methods side by side, or empty."""


def offered(rig: Any) -> list[str]:
    """Return all methods by name: what is on the page, the file's own, and the registered."""
    file_methods = ["artist"] if rig is not None and rig.weights is not None else []
    return [NOW, *file_methods, *(name for name in METHODS if name != "artist")]


def listed(rig: Any, chosen: Sequence[str]) -> list[str]:
    """Return the methods that are offered, and those of the chosen that are settings."""
    return [*offered(rig), *(name for name in chosen if is_settings(name))]


def standard(rig: Any, base: str = "computed") -> list[str]:
    """Return the methods that stand side by side before any is chosen.

    Over a file's weights, what is on the page would be the same twice.
    """
    first = NOW if base == "computed" else "cutcell_rig"
    return [name for name in offered(rig) if name in (first, "artist", "euclidean")]


PANEL = Panel("Compare", '<path d="M4 5h6v14H4zM14 5h6v14h-6zM12 2.5v19"/>', poses=True)


class Choices(param.Parameterized):
    """Which methods stand side by side, and what of them is seen."""

    methods = param.List([NOW, "euclidean"], doc="Names of the methods, two to four.")
    compared = param.Dict({}, doc="A Compared for each method that was tried on this rig.")
    compare_field: param.Selector[str] = param.Selector(
        default="bone", objects=["bone", "branch", "all", "error"]
    )
    added_option: param.Selector[str] = param.Selector(
        default="resolution", objects={**OPTIONS, "Nothing": ""}, label="Change"
    )
    added_value = param.String("", doc="Its value in settings that are to be added.")
    clicked_method = param.String("", doc="The method whose view was clicked last.")
    minus = param.String("", doc="The method that is taken away from all; empty for none.")
