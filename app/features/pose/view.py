"""The motion that runs in the browser, and the rings that turn a joint."""

from ...looks.pose import gizmo_part
from .results import is_playing, motion_part, watch

__all__ = ["PARTS", "watch"]

PARTS = {"clip": motion_part, "playing": is_playing, "gizmo": gizmo_part}
