"""Reading of files as characters."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import cutcell
from cutcell.editing.stored import with_base
from cutcell.errors import FileError
from cutcell.io.files import naming
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_assets import demo_path

from ..derive.processes import MAX_SECONDS, in_process

IMAGES = ".png .jpg .jpeg .webp .bmp .tga .tif .tiff .dds .psd .ktx2"
COMPANIONS = {".txt", ".json", ".mtl", ".bin", *IMAGES.split()}
"""Endings of files that belong to the one that is opened."""

ENDED = "reading it came to a sudden end; the file is damaged, or needs more memory than there is"


@functools.cache
def demo_rig(id: str) -> Rig:
    """Return a demo character, which is read once and read-only."""
    return cutcell.load(demo_path(id))


def read(path: Path, check: Callable[[], object] = lambda: None) -> Rig:
    """Load a character in another process; see `in_process`."""
    with naming(path):
        return frozen(
            in_process(load_with_materials, path, check=check, ended=ENDED, limit=MAX_SECONDS)
        )


def reported(stage: str, load: Callable[[Callable[[], object]], Any]) -> Callable[[Progress], Any]:
    """Return a function that loads a character, and reports that as a stage."""

    def work(progress: Progress) -> Any:
        progress(stage, 0.0)
        return load(lambda: progress(stage, 0.0))

    return work


def load_with_materials(path: Path) -> Rig:
    """Load a character with its materials, and the weights below the layers of its file."""
    rig = with_base(cutcell.load(path))
    has_materials(rig)  # the page must not wait for it later
    return rig


def frozen(rig: Rig) -> Rig:
    """Make the arrays of a copied rig read-only, as those of a new one are."""
    meshes, motions = [one.mesh for one in rig.attachments], [clip.motion for clip in rig.clips]
    for part in (rig, rig.mesh, rig.skeleton, *meshes, *motions):
        for value in vars(part).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
    return rig


def main_file(paths: list[Path]) -> Path:
    """Return the only character of a dropped group; raise an error for none or several."""
    characters = [path for path in paths if path.suffix.lower() not in COMPANIONS]
    names = ", ".join(path.name for path in paths)
    if not characters:
        raise FileError(
            f"no character among the dropped files ({names}); drop a GLB, FBX or another "
            "supported file"
        )
    if len(characters) > 1:
        raise FileError(f"more than one character was dropped ({names}); drop one at a time")
    return characters[0]
