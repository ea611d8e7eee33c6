"""RigNet: a text file, with its mesh in an OBJ beside it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...rig import Rig
    from ..skeletons import SkeletonFile

SUFFIXES = {".txt": rb"(joints|root|hier|skin)\s"}
NOTE = "RigNet, with an .obj"


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a rig."""
    from ..rignet import read_rignet

    return read_rignet(path)


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the skeleton, whose mesh need not exist."""
    from ..rignet import read_rignet_skeleton
    from ..skeletons import SkeletonFile

    return SkeletonFile(read_rignet_skeleton(path))


def check(path: Path, rig: Rig | None) -> None:
    """Refuse to replace another mesh."""
    from ..rignet import check_mesh_file

    if rig is not None:
        check_mesh_file(path, rig.mesh)


def write(path: Path, rig: Rig) -> dict[Path, bytes]:
    """Return the mesh, unless it is there, and the text file of a rig."""
    from ..rignet import rignet_files

    return rignet_files(path, rig)
