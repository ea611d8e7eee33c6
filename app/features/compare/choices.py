"""Choices of the panel Compare."""

from __future__ import annotations

import param

from ...document.side_by_side import NOW
from ...document.state import Panel
from .lab.choices import OPTIONS

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
