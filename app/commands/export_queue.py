"""Queue of exports: each waits for the weights that the page is about to show.

No export stops other work, and no other work stops an export.
"""

from collections.abc import Callable

from ..state.method import GRAPH, WEIGHTS
from .binding import is_current, is_pending
from .session import Session

WAITING = "waiting for the weights"
"""The stage of an export before there is what it exports."""


def watch(session: Session) -> None:
    """Begin the next export when weights arrive, and when a choice is taken back."""
    session.state.param.watch(
        lambda *events: session.tasks.later(lambda: proceed(session)),
        ["binding", "bare_graph", "busy", "corrections", *GRAPH, *WEIGHTS],
    )


def when_ready(session: Session, export: Callable[[], None]) -> None:
    """Call a function that exports what the page shows, once that follows all choices.

    Choices that change until then count. Where no weights come, nothing is exported.
    """
    session.exports.append(export)
    proceed(session)


def proceed(session: Session) -> None:
    """Begin the next export, unless one is being written or has to wait."""
    while session.exports and not session.tasks.jobs("export").running:
        if not is_current(session) and is_pending(session):
            session.report("export", WAITING, 0.0)
            return
        session.ended("export")
        session.exports.pop(0)()
