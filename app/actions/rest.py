"""Tells who asks whether anything is still under way: tests, before they look."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..session import Session

AFTER = 0.1
"""Seconds to wait with the answer: Panel holds what a widget says for half as long."""


def watch(session: Session) -> None:
    """Answer when asked."""

    def asked(message: dict[str, Any]) -> None:
        timer = threading.Timer(AFTER, lambda: session.later(answer))
        timer.daemon = True
        timer.start()

    def answer() -> None:
        session.view.answer(rests=not session.working)

    session.view.listen("rests?", asked)
