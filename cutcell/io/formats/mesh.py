"""Meshes with a skeleton in a JSON file beside them, or without one; an OBJ may be RigNet's."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...rig import Rig

SUFFIXES = {
    ".obj": rb"\s*(#|(mtllib|usemtl|v|vt|vn|o|g|s)\s)",
    ".ply": rb"ply\s",
    ".stl": rb"solid\s",
    ".off": rb"\w{0,4}OFF\s",
}
NOTE = "a mesh, with a skeleton in a .json beside it"


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a mesh, with the skeleton beside it unless `bare`."""
    from ..meshes.mesh_files import read_soup
    from ..rignet import read_rignet, rig_file

    rig = rig_file(path) if path.suffix.lower() == ".obj" and not bare else None
    return read_rignet(rig) if rig else read_soup(path, bare)
