"""A skeleton in JSON, for a mesh in another file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..skeletons import SkeletonFile

SUFFIXES = {".json": rb'\s*\{\s*"joints"'}
NOTE = ""


def read_skeleton(path: Path) -> SkeletonFile:
    """Read a skeleton, and which of its joints deform if the file says so."""
    import numpy as np

    from ..meshes.mesh_files import read_skeleton_json
    from ..skeletons import SkeletonFile

    skeleton, says_deform = read_skeleton_json(path)
    return SkeletonFile(skeleton, stored=skeleton.deform.astype(np.int8) if says_deform else None)
