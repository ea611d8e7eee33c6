"""Files as characters: which of a group is opened, and how it is read."""

import functools
from collections.abc import Callable
from pathlib import Path

import numpy as np

import cutcell
from cutcell.errors import FileError
from cutcell.io.files import naming
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig
from cutcell_assets import demo_path

from ..jobs.processes import MAX_SECONDS, in_process

IMAGES = {
    ".png",
    ".jpg",
    ".jpeg",
    ".webp",
    ".bmp",
    ".tga",
    ".tif",
    ".tiff",
    ".dds",
    ".psd",
    ".ktx2",
}
COMPANIONS = {".txt", ".json", ".mtl", ".bin", *IMAGES}
"""Files that come along with the one that is opened."""


ENDED = "reading it came to a sudden end; the file is damaged, or needs more memory than there is"


@functools.cache
def demo_rig(id: str) -> Rig:
    """Return a demo character; it is read once, and nothing can write to it."""
    return cutcell.load(demo_path(id))


def read(path: Path, check: Callable[[], object] = lambda: None) -> Rig:
    """Load a character in another process; see `jobs.processes.in_process`."""
    with naming(path):
        return frozen(
            in_process(load_with_materials, path, check=check, ended=ENDED, limit=MAX_SECONDS)
        )


def load_with_materials(path: Path) -> Rig:
    """Load a character, and look which materials it has: some formats read them when asked."""
    rig = cutcell.load(path)
    has_materials(rig)  # the page asks as soon as it shows it, and must not wait then
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
    """Return the one file of a dropped group that is to be opened.

    Raises
    ------
    FileError
        There is none, or more than one.
    """
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
