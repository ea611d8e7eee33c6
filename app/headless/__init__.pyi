from .address import choices_at, read_address
from .choices import RENDERED, Choices, state_of
from .names import bone_index, clip_named
from .options import read_choices, read_settings, read_size
from .order import VIEWS, Picture, order
from .scene import describe, describe_sweep, textures_for

__all__ = [
    "RENDERED",
    "VIEWS",
    "Choices",
    "Picture",
    "bone_index",
    "choices_at",
    "clip_named",
    "describe",
    "describe_sweep",
    "order",
    "read_address",
    "read_choices",
    "read_settings",
    "read_size",
    "state_of",
    "textures_for",
]
