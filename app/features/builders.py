"""Builders of the panels: each draws the `CONTROLS` of `NAME/controls.py` for a session."""

from collections.abc import Callable
from functools import partial
from typing import Any

from ..document.session import Session
from ..widgets.table import draw
from . import modules
from .state import PANELS

_MODULES = modules("controls")

BUILDERS: dict[str, Callable[[Session], Any]] = {
    panel: partial(draw, row=_MODULES[panel].CONTROLS, panel=panel) for panel in PANELS
}
