"""A place in the sidebar to drop files on."""

from typing import Any

import param
from panel.custom import JSComponent

from ..files.receive import Receiver
from .modules import script


class FileDrop(JSComponent):
    """A place to drop files on, or to choose them with a click."""

    label = param.String("Drop a character here, or browse")
    hint = param.String("")

    _esm = script("widgets/file_drop")

    def __init__(self, receiver: Receiver, **params: Any) -> None:
        super().__init__(**params)
        self._receiver = receiver

    def _handle_msg(self, data: dict[str, Any]) -> None:
        answer = self._receiver.answer(data)
        if answer is not None:
            self._send_msg({"upload": answer})
