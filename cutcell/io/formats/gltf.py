"""glTF 2.0, and avatars in VRM."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...rig import Rig
    from ..skeletons import SkeletonFile

SUFFIXES = {".glb": rb"glTF", ".gltf": rb"\s*\{", ".vrm": rb"glTF"}
NOTE = ""


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a rig."""
    from ..gltf.read.read import read_gltf

    return read_gltf(path, accessories, bare)


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the joints of the skins of a document, else its bones, and the clips."""
    from ..skeletons import of_gltf

    return of_gltf(path)


def check(path: Path, rig: Rig | None) -> None:
    """Refuse what ``write`` would refuse, whatever the weights will be."""
    from ..gltf.write.files import check_gltf

    if rig is not None:
        check_gltf(path, rig)


def write(path: Path, rig: Rig) -> dict[Path, bytes]:
    """Return the files of a rig: its own document, or a new one."""
    from ..gltf.write.files import gltf_files

    return gltf_files(path, rig)
