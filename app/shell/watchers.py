"""Connections of a new session: the results of all features, and what follows its state."""

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from ..document import arrival, look, recording
from ..document.session import Session
from ..document.state import UNSEEN
from ..features import FEATURES
from ..features.brush import strokes as brush
from ..features.correct import moving
from ..features.cut import commands as cut
from ..features.learn import steps as lesson
from ..features.select import selections
from ..features.weights import recovery
from ..features.weights import results as weights
from . import export_queue, idle, keys, rendered, view_parts

_NAMES = [f"cutcell_app.features.{name}.results" for name in FEATURES]
MODULES: list[Any] = [import_module(name) for name in _NAMES if find_spec(name)]
"""The results of all features that have any."""

WATCHING = (
    look, view_parts, cut, moving, brush, selections, *MODULES, rendered, recovery, export_queue,
    recording, keys, idle, arrival, lesson,
)  # fmt: skip
"""In this order: what is seen comes before what is computed for it."""


def follow(session: Session) -> None:
    """Connect everything to the state of a new session."""
    others = [result for module in MODULES if module is not weights for result in module.RESULTS]
    results = [*weights.RESULTS, *others]  # others follow the binding
    # First, so that nothing sees a value that no longer holds.
    session.engine.declare(results, UNSEEN - {"demo"})
    for one in WATCHING:
        if hasattr(one, "watch"):
            one.watch(session)
