"""Connections of a new session: its results, its view, and what else follows its state."""

from typing import Any

from ...document import loading, look, recording
from ...document.session import Session
from ...features import FEATURES, results
from . import export_queue, idle, keys, rendered, view_parts

WATCHING: tuple[Any, ...] = (
    export_queue, idle, keys, loading, look, recording, rendered, view_parts, *FEATURES.values(),
)  # fmt: skip
"""In any order: results come first, and views of the state last; see `Engine.follow`."""


def follow(session: Session) -> None:
    """Connect everything to the state of a new session."""
    session.engine.declare(results())
    for one in WATCHING:
        one.watch(session)
