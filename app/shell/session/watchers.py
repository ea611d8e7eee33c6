"""Connections of a new session: the results of all features, and what follows its state."""

from typing import Any

from ...document import loading, look, recording
from ...document.session import Session
from ...document.state import UNSEEN
from ...editing.binding import recovery
from ...editing.brush import strokes as brush
from ...editing.correct import moving
from ...editing.select import selections
from ...features import modules
from ...features.learn import steps as lesson
from ...looks import cut
from . import export_queue, idle, keys, rendered, view_parts

MODULES: list[Any] = [*modules("results").values()]
"""The results of all features that have any."""

WATCHING = (
    look, view_parts, cut, moving, brush, selections, *MODULES, rendered, recovery, export_queue,
    recording, keys, idle, loading, lesson,
)  # fmt: skip
"""In this order: what is seen comes before what is computed for it."""


def follow(session: Session) -> None:
    """Connect everything to the state of a new session."""
    results = [result for module in MODULES for result in module.RESULTS]
    # First, so that nothing sees a value that no longer holds.
    session.engine.declare(results, UNSEEN - {"demo"})
    for one in WATCHING:
        if hasattr(one, "watch"):
            one.watch(session)
