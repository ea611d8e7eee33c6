"""Answers whether any work is still running: for tests, before they look."""

import threading
from typing import Any

from .session import Session

AFTER = 0.06
"""Seconds to wait with the answer: Panel holds what a widget says for 0.05 of them."""


def watch(session: Session) -> None:
    """Answer when asked."""

    def schedule(message: dict[str, Any]) -> None:
        timer = threading.Timer(AFTER, lambda: session.tasks.later(answer))
        timer.daemon = True
        timer.start()

    def answer() -> None:
        session.view.answer(rests=not session.tasks.running)

    session.view.listen("rests?", schedule)
