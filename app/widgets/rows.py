"""A short list of things that can be chosen, each with a number and a bar."""

from typing import Any

import param

from .modules import Clickable, script


class Rows(Clickable):
    """Rows in order, usually longest bar first; a click reports the number of its row."""

    rows = param.List([], doc="(name, text at its end, length of its bar from 0 to 1).")
    chosen = param.Integer(-1, doc="The row that is marked; -1 for none.")
    label = param.String("", doc="Name of the list for a screen reader.")

    _esm = script("rows")

    def _handle_msg(self, data: dict[str, Any]) -> None:
        if 0 <= int(data["row"]) < len(self.rows):
            self.click(int(data["row"]))
