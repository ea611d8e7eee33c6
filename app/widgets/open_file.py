"""A button that opens a small text file of this person's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from .modules import script


class OpenFile(JSComponent):
    """A button that lets a file be chosen, and tells the text in it.

    Parameters
    ----------
    on_open : callable
        Called with the text.
    """

    label = param.String("Open")
    accept = param.String("", doc="Endings of the files that are offered.")
    most = param.Integer(4 * 2**20, doc="Bytes; larger files are not sent.")

    _esm = script("open_file")

    def __init__(self, on_open: Callable[[str], None], **params: Any) -> None:
        super().__init__(**params)
        self._on_open = on_open

    def _handle_msg(self, data: dict[str, Any]) -> None:
        self._on_open(str(data["text"]))
