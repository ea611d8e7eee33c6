"""The data that flows through cutcell: a mesh, a skeleton, and both together as a rig.

All are frozen and checked when they are made, so that no later stage meets a bad array.
"""

from .clip import Clip
from .mesh import TriangleMesh
from .rig import Attachment, LeftOut, Part, Rig
from .skeleton import Skeleton, with_origin

__all__ = [
    "Attachment",
    "Clip",
    "LeftOut",
    "Part",
    "Rig",
    "Skeleton",
    "TriangleMesh",
    "with_origin",
]
