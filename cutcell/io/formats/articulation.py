"""Articulation-XL 2.0: a rig as arrays in an npz archive."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...rig import Rig
    from ..skeletons import SkeletonFile

SUFFIXES = {".npz": rb"PK[\0-\xff]{28}\w+\.npy"}
NOTE = "Articulation-XL"


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a rig."""
    from ..articulation import read_articulation

    return read_articulation(path)


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the skeleton of a rig."""
    from ..skeletons import SkeletonFile

    return SkeletonFile(read(path).skeleton)


def write(path: Path, rig: Rig) -> dict[Path, bytes]:
    """Return the archive of a rig."""
    from ..articulation import articulation_bytes

    return {path: articulation_bytes(rig)}
