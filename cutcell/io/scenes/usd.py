"""USD files with UsdSkel, read in a subprocess where usd-core is installed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError
from ...isolated.run import WorkFailedError, run_isolated
from ...rig import Rig
from ..files import read_bytes
from ..gltf.read.read import read_rig
from .document import dropped_note, scene_document
from .joints import scene_world

USD = (".usd", ".usda", ".usdc", ".usdz")
SECONDS, MEMORY = 120.0, 2**32
LOST = (
    "of a USD, the meshes, skeletons, weights and motion are read, with normals, texture "
    "coordinates, and of its materials the base colours with their images; it is saved as a GLB "
    "without what else its materials have"
)


def read_usd(path: Path, accessories: bool = False) -> Rig:
    """Load a USD file; see `cutcell.load`."""
    scene = usd_scene(path)
    document = scene_document(scene, path, "cutcell, from USD")
    document.warnings.append(LOST + dropped_note(scene))
    return read_rig(document, path, scene_world(scene), accessories)


def usd_scene(path: Path) -> Mapping[str, NDArray]:
    """Return the arrays of a USD file; see `document`."""
    read_bytes(path)  # says what it says of every file: not there, a folder, empty
    try:
        return run_isolated(
            "cutcell.isolated.usd:read",
            {"path": np.array(str(path.resolve()))},
            SECONDS,
            "the USD reader",
            MEMORY,
            extra="cutcell[usd]",
        )
    except WorkFailedError as e:
        raise FileError(f"cannot be read as USD: {e}") from None
