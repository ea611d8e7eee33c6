"""The motion that runs in the browser, and the rings that turn a joint."""

from .results import is_playing, motion_part, watch
from .scene import gizmo_part

__all__ = ["PARTS", "watch"]

PARTS = {"clip": motion_part, "playing": is_playing, "gizmo": gizmo_part}
