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
            case PointAtRow(name, nth):
                self.pointed = self._place(name, nth)
            case PickRow(name, nth) if (row := self._place(name, nth)) >= 0:
                self.click(row)

    def _place(self, name: str | None, nth: int) -> int:
        """Return the number of the nth row of a name; -1 if there is none."""
        rows = [row for row, (other, *_) in enumerate(self.rows) if other == name]
        return rows[nth] if 0 <= nth < len(rows) else -1
