"""USD with UsdSkel."""

from __future__ import annotations

from pathlib import Path

from ...rig import Rig
from ..scenes import read_scene, read_scene_skeleton
from ..skeletons import SkeletonFile

SUFFIXES = {".usd": rb"PXR-USDC|#usda", ".usda": rb"#usda", ".usdc": rb"PXR-USDC", ".usdz": rb"PK"}
NOTE = "with cutcell[usd]"


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a rig."""
    return read_scene(path, "USD", accessories)


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the skeleton and the clips of a scene."""
    return read_scene_skeleton(path, "USD")
