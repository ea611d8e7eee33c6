"""What a person can choose on the panel Compare."""

from __future__ import annotations

from typing import Any

import param

NOW = "now"
"""Stands among the methods for what the page computed, as it is set."""

MOST_VIEWS = 4


class CompareChoices(param.Parameterized):
    """Which methods stand side by side, and what of them is seen."""

    methods: Any = param.List([NOW, "euclidean"], doc="Names of the methods, two to four.")
    compared: Any = param.Dict({}, doc="A Compared for each method that was tried on this rig.")
    comparing: Any = param.String("", doc="The method that is being computed; empty for none.")
    compare_field: Any = param.Selector(default="bone", objects=["bone", "all", "error"])
    minus: Any = param.String("", doc="The method that is taken away from all; empty for none.")
