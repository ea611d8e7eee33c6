"""The panels of the page, one file each: `NAME(session) -> Viewable` builds its controls."""

from collections.abc import Callable
from importlib import import_module
from typing import Any

from ..commands.session import Session
from ..state import PANELS

BUILDERS: dict[str, Callable[[Session], Any]] = {
    panel: getattr(import_module(f".{panel}", __name__), panel) for panel in PANELS
}
