"""FBX and USD files, read in a subprocess and converted to a glTF document."""

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

USD = (".usd", ".usda", ".usdc", ".usdz")
SCENES = (".fbx", *USD)
FBX_BINARY = b"Kaydara FBX Binary"
SECONDS, SECONDS_A_MEGABYTE = 60.0, 5.0
MIN_MEMORY, MEMORY_A_BYTE = 2**30, 100
"""Limits of the FBX reader. A byte of text takes some 20; arrays may be packed."""
USD_SECONDS, USD_MEMORY = 120.0, 2**32
READ = {
    "FBX": "meshes, skeleton, weights and clips",
    "USD": "meshes, skeletons, weights and motion",
}


def read_scene(path: Path, accessories: bool = False) -> Rig:
    """Load an FBX or USD file; see `cutcell.load`."""
    kind, scene = _kind(path), scene_arrays(path)
    document = scene_document(scene, path, f"cutcell, from {kind}")
    lost = (
        f"of {'an' if kind == 'FBX' else 'a'} {kind}, the {READ[kind]} are read, with normals, "
        "texture coordinates, and of its materials the base colours with their images; it is saved "
        "as a GLB without what else its materials have"
    )
    document.warnings += [lost + dropped_note(scene), *map(str, scene.get("notes", ()))]
    return read_rig(document, path, scene_world(scene), accessories, why_bare=_why_bare(scene))


def scene_arrays(path: Path) -> Mapping[str, NDArray]:
    """Return the arrays of an FBX or USD file; see `document`."""
    data, kind = read_bytes(path), _kind(path)
    job = {"path": np.array(str(path.resolve()))}
    seconds, memory, extra = USD_SECONDS, USD_MEMORY, "cutcell[usd]"
    if kind == "FBX":
        if not data.startswith(FBX_BINARY) and b"FBX" not in data[:4096]:
            raise FileError(
                "is not an FBX file: neither binary nor text in its first lines says so"
            )
        job, extra = {"data": np.frombuffer(data, np.uint8)}, "cutcell"
        seconds = SECONDS + SECONDS_A_MEGABYTE * len(data) / 2**20
        memory = MIN_MEMORY + MEMORY_A_BYTE * len(data)
    task, who = f"cutcell.isolated.{kind.lower()}:read", f"the {kind} reader"
    try:
        return run_isolated(task, job, seconds, who, memory, extra)
    except WorkFailedError as e:
        raise FileError(f"cannot be read as {kind}: {e}") from None


def _kind(path: Path) -> str:
    return "USD" if path.suffix.lower() in USD else "FBX"


def _why_bare(scene: Mapping[str, NDArray]) -> str:
    """Return why a scene has no joints, if blend shapes move its meshes."""
    blended = scene.get("blended", np.zeros(0))
    if not len(blended):
        return ""
    return (
        "it has no bones: only blend shapes, which are not read, move its meshes "
        f"({listed(blended.tolist())}). Give it a skeleton from another file, or fit one"
    )
