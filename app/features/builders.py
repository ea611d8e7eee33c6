"""Builders of the panels: each draws the `CONTROLS` of `NAME/controls.py` for a session."""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from ..document.session import Session
from ..document.state import PANELS
from ..widgets.table import draw

BUILDERS: dict[str, Callable[[Session], Any]] = {
    panel: partial(draw, row=import_module(f"{__package__}.{panel}.controls").CONTROLS, panel=panel)
    for panel in PANELS
}
