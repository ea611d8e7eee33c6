"""A short list of things that can be chosen, each with a number and a bar."""

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from .modules import script


class Rows(JSComponent):
    """Rows in order, usually longest bar first; a click on one calls a function.

    Parameters
    ----------
    on_choose : callable
        Called with the number of the row that was clicked.
    """

    rows = param.List([], doc="(name, what stands at its end, length of its bar from 0 to 1).")
    chosen = param.Integer(-1, doc="The row that is marked; -1 for none.")
    label = param.String("", doc="What the list is called to a screen reader.")

    _esm = script("rows")

    def __init__(self, on_choose: Callable[[int], None], **params: Any) -> None:
        super().__init__(**params)
        self._on_choose = on_choose

    def _handle_msg(self, data: dict[str, Any]) -> None:
        if 0 <= int(data["row"]) < len(self.rows):
            self._on_choose(int(data["row"]))
