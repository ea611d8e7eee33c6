"""A table of numbers that is sorted by its headings, with cells that can be edited."""

import param

from ..server.protocol.received import Message, PickBars
from .modules import Clickable, script


class WeightsTable(Clickable):
    """A page of a table of vertices; it reports sorting, paging, clicks on rows and edits.

    Its content has "columns" (heading, joint; what is below 0 is not edited; vertices come first),
    "rows" and "totals" (lists of numbers after a vertex or a name), "order" (the sorting column,
    whether the largest come first) and "pages" (number of the page, and how many there are).
    """

    content = param.Dict({}, doc="The table; empty for none.")
    label = param.String("Weights", doc="Name of the table for a screen reader.")

    _esm = script("tables/weights_table")

    def receive(self, message: Message) -> None:
        """Report what is done with the table."""
        self.click(message)


class Histogram(Clickable):
    """Bars to choose, by clicks, drags or keys; it reports the first and the last one."""

    bars = param.List([], doc="(range, count) of each bar.")
    chosen = param.List([], doc="First and last chosen bar; empty for none.")
    label = param.String("Histogram", doc="Name for a screen reader.")

    _esm = script("tables/histogram")

    def receive(self, message: Message) -> None:
        """Report the bars that are chosen."""
        match message:
            case PickBars(first, last) if 0 <= first <= last < len(self.bars):
                self.click((first, last))
