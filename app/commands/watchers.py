"""Watchers of a page's state: each `watch(session)` runs a command on changes."""

from . import (
    arrival,
    binding,
    brush,
    check,
    compare,
    cutting,
    distance,
    explain,
    export_queue,
    history,
    idle,
    keys,
    look,
    materials,
    moving,
    pairs,
    pose,
    rendered,
)
from .session import Session


def follow(session: Session) -> None:
    """Connect everything to the state of a new session."""
    # In this order: what is seen comes before what is computed for it.
    watched = (look, cutting, moving, brush, distance, pose, materials, compare, pairs, rendered)
    for one in (*watched, binding, export_queue, explain, history, keys, idle, check, arrival):
        one.watch(session)
