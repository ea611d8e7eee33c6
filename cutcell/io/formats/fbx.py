"""FBX 6.1 to 7.7, binary and text."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...rig import Rig
    from ..skeletons import SkeletonFile

SUFFIXES = {".fbx": rb"Kaydara FBX|;\s*FBX"}
NOTE = ""


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a rig."""
    from ..scenes.document import read_scene

    return read_scene(path, "FBX", accessories)


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the skeleton and the clips of a scene."""
    from ..skeletons import of_scene

    return of_scene(path, "FBX")
