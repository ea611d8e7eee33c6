"""FBX 6.1 to 7.7, binary and text."""

from __future__ import annotations

from pathlib import Path

from ...rig import Rig
from ..scenes import read_scene, read_scene_skeleton
from ..skeletons import SkeletonFile

SUFFIXES = {".fbx": rb"Kaydara FBX|;\s*FBX"}
NOTE = ""


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a rig."""
    return read_scene(path, "FBX", accessories)


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the skeleton and the clips of a scene."""
    return read_scene_skeleton(path, "FBX")
