"""The page's scenes without the page: for `cutcell render`, and for notebooks."""

from .address import Address, read_address
from .choices import RENDERED, VIEWS, Choices, check
from .names import find_bone, find_clip
from .options import settings_of
from .order import check_picture, order
from .scene import describe, describe_sweep, textures_for

__all__ = [
    "RENDERED",
    "VIEWS",
    "Address",
    "Choices",
    "check",
    "check_picture",
    "describe",
    "describe_sweep",
    "find_bone",
    "find_clip",
    "order",
    "read_address",
    "settings_of",
    "textures_for",
]
