"""Curves with a button at each point."""

from typing import Any

import param

from .modules import Clickable, script


class Curves(Clickable):
    """Plots below each other; a click on a point reports its id."""

    plots = param.List([], doc="See `features/compare/lab/curves.py`.")

    _esm = script("curves")

    def _handle_msg(self, data: dict[str, Any]) -> None:
        curves = [curve for plot in self.plots for curve in plot["curves"]]
        if str(data["id"]) in {point["id"] for curve in curves for point in curve["points"]}:
            self.click(str(data["id"]))
