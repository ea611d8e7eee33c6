"""A short list of things that can be chosen, each with a number and a bar."""

import param

from ..server.protocol.received import Message, PickRow, PointAtRow
from .modules import Clickable, script


class Rows(Clickable):
    """Rows in order, usually longest bar first; a click reports the number of its row."""

    rows = param.List([], doc="(name, text at its end, length of its bar from 0 to 1).")
    chosen = param.Integer(-1, doc="The row that is marked; -1 for none.")
    pointed = param.Integer(-1, doc="The row under the pointer or with the focus; -1 for none.")
    points = param.Boolean(False, doc="Whether the browser reports that row.")
    label = param.String("", doc="Name of the list for a screen reader.")

    _esm = script("tables/rows")

    def receive(self, message: Message) -> None:
        """Note the row under the pointer; report one that is clicked."""
        match message:
            case PointAtRow(row):
                self.pointed = row if 0 <= row < len(self.rows) else -1
            case PickRow(row) if 0 <= row < len(self.rows):
                self.click(row)
