"""The page's scenes without the page: for `cutcell render`, and for notebooks."""

from .choices import RENDERED, VIEWS, Choices, check
from .names import find_bone, find_clip
from .options import settings_of
from .order import order
from .scene import describe, textures_for

__all__ = [
    "RENDERED",
    "VIEWS",
    "Choices",
    "check",
    "describe",
    "find_bone",
    "find_clip",
    "order",
    "settings_of",
    "textures_for",
]
