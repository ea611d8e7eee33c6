"""The line over the canvas on a first visit: what the page is for, and three ways in."""

from typing import Any

import param

from ..commands.loading import receiver
from ..commands.session import Session
from ..commands.tour import go
from ..state.tour import TOUR
from .file_drop import FileDrop
from .modules import script


class Welcome(FileDrop):
    """Shows the line until it is closed; a browser that closed it never shows it again."""

    headline = param.String(
        "Skin should follow its own bones, so measure distance through the body."
    )
    leak = param.Integer(doc="The step of the tour that shows why weights leak.")
    touring = param.Boolean(False, doc="Whether a step of the tour is shown.")

    _esm = script("welcome")

    def __init__(self, session: Session, **params: Any) -> None:
        leak = next(i for i, step in enumerate(TOUR) if "methods" in step.look.choices)
        super().__init__(receiver(session), leak=leak, margin=0, **params)
        self._session = session
        session.state.param.watch(lambda event: self.param.update(touring=event.new >= 0), "tour")

    def _handle_msg(self, data: dict[str, Any]) -> None:
        if data.get("type") == "step":
            go(self._session, int(data["step"]))
        else:
            super()._handle_msg(data)
