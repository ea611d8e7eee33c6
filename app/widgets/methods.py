"""The table of methods: which are seen, and how good they are."""

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from .modules import script


class Methods(JSComponent):
    """A table with a box to tick in each row.

    Parameters
    ----------
    on_choose : callable
        Called with a method's name and whether it is chosen now.
    """

    columns = param.List([], doc="(heading, what it means) of the columns after the name.")
    rows = param.List([], doc="id, title, values, note, and state of each; see `js/methods.js`.")
    label = param.String("Methods", doc="What the table is called to a screen reader.")

    _esm = script("methods")

    def __init__(self, on_choose: Callable[[str, bool], None], **params: Any) -> None:
        super().__init__(**params)
        self._on_choose = on_choose

    def _handle_msg(self, data: dict[str, Any]) -> None:
        if str(data["id"]) in {row["id"] for row in self.rows}:
            self._on_choose(str(data["id"]), bool(data["on"]))
