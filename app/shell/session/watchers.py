"""Connections of a new session: the results of all features, and what follows its state."""

from typing import Any

from ...document import loading, look, recording
from ...document.session import Session
from ...editing.binding import recovery
from ...editing.brush import strokes as brush
from ...editing.correct import moving
from ...editing.select import selections
from ...features import modules, results
from ...features.learn import steps as lesson
from ...looks import cut
from . import export_queue, idle, keys, rendered, view_parts

WATCHING: tuple[Any, ...] = (
    brush, cut, export_queue, idle, keys, lesson, loading, look, moving, recording, recovery,
    rendered, selections, view_parts, *modules("results").values(),
)  # fmt: skip


def follow(session: Session) -> None:
    """Connect everything to the state of a new session."""
    session.engine.declare(results())
    for one in WATCHING:
        if hasattr(one, "watch"):
            one.watch(session)
