"""Parts of the view that follow from choices: handles, bones, motions; sent when they change."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...document.framing import bones_part
from ...document.session import Session
from ...document.state import UNSEEN
from ...editing.brush.strokes import brush_part
from ...editing.correct.moving import handle_part
from ...editing.select.selections import lasso_part
from ...features.distance.results import wave_part
from ...features.pose.results import motion_part
from ...looks.cut import plane_part
from ...looks.pose import gizmo_part

PARTS: dict[str, Callable[[Session], Any]] = {
    "handles": plane_part,
    "bones": lambda session: bones_part(session.state),
    "mover": handle_part,
    "brush": brush_part,
    "lasso": lasso_part,
    "animation": wave_part,
    "clip": motion_part,
    "playing": lambda session: session.state.playing and motion_part(session) is not None,
    "gizmo": lambda session: gizmo_part(session.state),
}
"""By the name in messages: a function that returns the part, or None for none."""


def watch(session: Session) -> None:
    """Send parts as they change."""
    state = session.state
    names = [name for name in state.param if name not in UNSEEN - {"playing"}]
    state.param.watch(lambda *events: send_changed(session), names)


def send_changed(session: Session) -> None:
    """Send the parts that the view does not have yet."""
    parts = {name: make(session) for name, make in PARTS.items()}
    last = session.view.last_sent
    changed = {name: part for name, part in parts.items() if not _same(part, last(name))}
    if changed:
        session.view.send(**changed)


def _same(one: Any, other: Any) -> bool:
    if one is other:
        return True
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_same(one[key], other[key]) for key in one)
    return type(one) is type(other) and bool(np.array_equal(one, other))
