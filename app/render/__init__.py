"""The page's scenes without the page: for `cutcell render`, and for notebooks."""

from .address import Address, read_address, read_camera
from .choices import PANELS, VIEWS, Choices, check
from .names import find_bone, find_clip
from .options import settings_of
from .order import order
from .scene import describe, textures_for

__all__ = [
    "PANELS",
    "VIEWS",
    "Address",
    "Choices",
    "check",
    "describe",
    "find_bone",
    "find_clip",
    "order",
    "read_address",
    "read_camera",
    "settings_of",
    "textures_for",
]
