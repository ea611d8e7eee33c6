"""Connections of a new session: the results of all features, and what follows its state."""

from typing import Any

from ..document import arrival, look, recording
from ..document.session import Session
from ..features.brush import strokes as brush
from ..features.correct import moving
from ..features.cut import commands as cut
from ..features.declared import MODULES, RESULTS
from ..features.learn import steps as lesson
from ..features.select import selections
from ..features.weights import recovery
from . import export_queue, idle, keys, rendered, view_parts

WATCHING: tuple[Any, ...] = (
    arrival, brush, cut, export_queue, idle, keys, lesson, look, moving, recording, recovery,
    rendered, selections, view_parts, *MODULES,
)  # fmt: skip


def follow(session: Session) -> None:
    """Connect everything to the state of a new session."""
    session.engine.declare(RESULTS)
    for one in WATCHING:
        if hasattr(one, "watch"):
            one.watch(session)
