"""Queue of exports: each waits for the weights that the page is about to show.

No export stops other work, and no other work stops an export.
"""

from collections.abc import Callable, Set

from ...derive.engine import WIDGETS
from ...document.session import Session
from ...editing.binding.recovery import is_current, is_pending


def watch(session: Session) -> None:
    """Begin the next export when weights arrive, and when a choice is taken back."""

    def changed(names: Set[str], is_reset: bool) -> None:
        if session.exports:
            session.work.later(lambda: proceed(session))

    session.engine.follow(changed, WIDGETS)


def when_ready(session: Session, export: Callable[[], None]) -> None:
    """Call a function that exports what the page shows, once that follows all choices.

    Choices that change until then count. Where no weights come, nothing is exported.
    """
    session.exports.append(export)
    proceed(session)


def proceed(session: Session) -> None:
    """Begin the next export, unless one is being written or has to wait."""
    while session.exports and not session.work.is_running("export"):
        if not is_current(session) and is_pending(session):
            break
        session.exports.pop(0)()
    session.show_progress()
