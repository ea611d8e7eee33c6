"""The line over the canvas on a first visit: what the page is for, and two ways in."""

from typing import Any

import param

from ...document.loading import receiver
from ...document.session import Session
from ...server.protocol.received import ShowStep
from ...widgets.file_drop import FileDrop
from ...widgets.modules import script
from .steps import go


class Welcome(FileDrop):
    """Shows the line until it is closed; a browser that closed it never shows it again."""

    headline = param.String(
        "Skin should follow its own bones, so measure distance through the body."
    )
    is_taught = param.Boolean(False, doc="Whether a step of the lesson is shown.")

    _esm = script("widgets/welcome")

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(receiver(session), margin=0, **params)
        self._session = session
        session.state.param.watch(lambda event: self.param.update(is_taught=event.new >= 0), "step")

    def _handle_msg(self, data: dict[str, Any]) -> None:
        if data.get("type") == ShowStep.type:
            go(self._session, 0)
        else:
            super()._handle_msg(data)
