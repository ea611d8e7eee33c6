"""Curves with a button at each point."""

import param

from ..server.protocol.received import Message, PickPoint
from .modules import Clickable, script


class Curves(Clickable):
    """Plots below each other; a click on a point reports its id."""

    plots = param.List([], doc="See `features/compare/lab/curves.py`.")

    _esm = script("tables/curves")

    def receive(self, message: Message) -> None:
        """Report the id of a point that is clicked."""
        curves = [curve for plot in self.plots for curve in plot["curves"]]
        ids = {point["id"] for curve in curves for point in curve["points"]}
        if isinstance(message, PickPoint) and message.id in ids:
            self.click(message.id)
