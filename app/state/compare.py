"""Choices of the panel Compare."""

from __future__ import annotations

from typing import Any

import param

from cutcell_lab.baselines import METHODS

NOW = "now"
"""Stands among the methods for what the page computed, as it is set."""

FEWEST_VIEWS = 2
MAX_VIEWS = 4


def offered(rig: Any) -> list[str]:
    """Return all methods by name: what is on the page, the file's own, and the registered."""
    file_methods = ["artist"] if rig is not None and rig.weights is not None else []
    return [NOW, *file_methods, *(name for name in METHODS if name != "artist")]


def standard(rig: Any) -> list[str]:
    """Return the methods that stand side by side before any is chosen."""
    return [name for name in offered(rig) if name in (NOW, "artist", "euclidean")]


class CompareChoices(param.Parameterized):
    """Which methods stand side by side, and what of them is seen."""

    methods = param.List([NOW, "euclidean"], doc="Names of the methods, two to four.")
    compared = param.Dict({}, doc="A Compared for each method that was tried on this rig.")
    comparing = param.String("", doc="The method that is being computed; empty for none.")
    queued = param.Boolean(False, doc="Whether it waits for what other sessions compare.")
    compare_field: param.Selector[str] = param.Selector(
        default="bone", objects=["bone", "all", "error"]
    )
    clicked_method = param.String("", doc="The method whose view was clicked last.")
    minus = param.String("", doc="The method that is taken away from all; empty for none.")
