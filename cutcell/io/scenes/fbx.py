"""FBX files, read in a subprocess and converted to a glTF document."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError
from ...isolated.run import WorkFailedError, run_isolated
from ...rig import Rig
from ...runtime.display import listed
from ..files import read_bytes
from ..gltf.read.read import read_rig
from .document import dropped_note, scene_document
from .joints import scene_world

BINARY = b"Kaydara FBX Binary"
SECONDS, SECONDS_A_MEGABYTE = 60.0, 5.0
MIN_MEMORY, MEMORY_A_BYTE = 2**30, 100
"""Memory limit of the reader. A byte of text takes some 20; arrays may be packed."""
LOST = (
    "of an FBX, the meshes, skeleton, weights and clips are read, with normals, texture "
    "coordinates, and of its materials the base colours with their images; it is saved as a GLB "
    "without what else its materials have"
)


def read_fbx(path: Path, accessories: bool = False) -> Rig:
    """Load an FBX file; see `cutcell.load`."""
    scene = fbx_scene(path)
    document = scene_document(scene, path, "cutcell, from FBX")
    document.warnings += [LOST + dropped_note(scene), *map(str, scene.get("notes", ()))]
    return read_rig(document, path, scene_world(scene), accessories, why_bare=_why_bare(scene))


def fbx_scene(path: Path) -> Mapping[str, NDArray]:
    """Return the arrays of an FBX file; see `document`."""
    data = read_bytes(path)
    if not data.startswith(BINARY) and b"FBX" not in data[:4096]:
        raise FileError("is not an FBX file: neither binary nor text in its first lines says so")
    seconds = SECONDS + SECONDS_A_MEGABYTE * len(data) / 2**20
    memory = MIN_MEMORY + MEMORY_A_BYTE * len(data)
    try:
        job = {"data": np.frombuffer(data, np.uint8)}
        return run_isolated("cutcell.isolated.fbx:read", job, seconds, "the FBX reader", memory)
    except WorkFailedError as e:
        raise FileError(f"cannot be read as FBX: {e}") from None


def _why_bare(scene: Mapping[str, NDArray]) -> str:
    """Return why a scene has no joints, if blend shapes move its meshes."""
    if not len(scene["blended"]):
        return ""
    names = listed(scene["blended"].tolist())
    return (
        f"it has no bones: only blend shapes, which are not read, move its meshes ({names}). Give "
        "it a skeleton from another file, or fit one"
    )
