"""Loading and saving rigs: ``load(path) -> Rig``, ``save(path, rig)``."""

from __future__ import annotations

import os
from pathlib import Path

from ..checks import check_has_joints
from ..errors import CutcellError, FileError
from ..rig import Rig
from .articulation import articulation_bytes, read_articulation
from .files import naming, read_bytes, write_all
from .gltf_container import MAGIC
from .gltf_fresh import new_glb
from .gltf_read import GltfSource, read_gltf
from .gltf_write import rewritten
from .rignet import read_rignet, rig_file, rignet_files
from .soup import MESHES, read_soup

__all__ = ["load", "save"]

GLTF = (".glb", ".gltf", ".vrm")
READABLE = "GLB, glTF, RigNet (.obj with .txt), Articulation-XL (.npz), or OBJ, PLY, STL, OFF"
WRITABLE = ".glb, .gltf, .txt (RigNet, with an .obj) or .npz (Articulation-XL)"


def load(path: str | os.PathLike[str], skeleton: str | os.PathLike[str] | None = None) -> Rig:
    """Load a rig.

    Parameters
    ----------
    path : path
        A GLB or glTF file; RigNet's ``.obj`` or ``.txt``; an Articulation-XL ``.npz``; or a
        mesh (OBJ, PLY, STL, OFF) with a skeleton in a JSON file beside it. A mesh without a
        skeleton becomes a rig without joints. ``docs/formats.md`` says what is taken from each.
    skeleton : path, optional
        The skeleton of a mesh, where it does not stand beside it under the mesh's name.

    Returns
    -------
    Rig
        Vertices in the file's order; weights where the file has any.

    Raises
    ------
    FileError
        No such file, not what its name says, or damaged.
    MeshError, SkeletonError, WeightsError
        What the file holds cannot be used. Every message names the file.
    """
    path = Path(path)
    with naming(path):
        return _load(path, None if skeleton is None else Path(skeleton))


def _load(path: Path, skeleton: Path | None) -> Rig:
    kind = path.suffix.lower()
    if skeleton is not None and kind not in MESHES:
        raise FileError(f"has a skeleton of its own; only {', '.join(MESHES)} take one beside")
    if kind == ".npz":
        return read_articulation(path)
    if kind == ".txt":
        return read_rignet(path)
    if kind in MESHES:
        rig = rig_file(path) if kind == ".obj" and skeleton is None else None
        return read_rignet(rig) if rig else read_soup(path, skeleton)
    if kind in GLTF or read_bytes(path)[:4] == MAGIC:
        return read_gltf(path)
    if kind == ".json":
        raise FileError("is not a mesh; give the mesh that this skeleton stands beside")
    raise FileError(f'"{kind}" cannot be read; give {READABLE} (from Blender: export as GLB)')


def save(path: str | os.PathLike[str], rig: Rig) -> None:
    """Save a rig.

    A rig that was loaded from glTF goes back into its own document, in which only the skin
    weights change; another one becomes a new GLB. The files are written under temporary
    names first, so that a failure leaves what was there, and a rig may be saved over the
    file it came from.

    Parameters
    ----------
    path : path
        Ends in ``.glb``, ``.gltf``, ``.txt`` (RigNet, with the mesh as an ``.obj`` beside it)
        or ``.npz`` (Articulation-XL).
    rig : Rig

    Raises
    ------
    FileError
        Another ending, or the file cannot be written.
    SkeletonError
        The rig has no joints, so that there are no weights to save.
    WeightsError
        The rig has no weights, or some that its glTF document cannot hold.
    """
    path = Path(path)
    with naming(path):
        check_has_joints(rig.skeleton)
        if not path.parent.is_dir():
            raise FileError(f"there is no folder {path.parent} to save it in")
        write_all(_files(path, rig))


def _files(path: Path, rig: Rig) -> dict[Path, bytes]:
    kind = path.suffix.lower()
    if kind == ".txt":
        return rignet_files(path, rig)
    if kind == ".npz":
        return {path: articulation_bytes(rig)}
    if kind in (".glb", ".gltf", ".vrm"):
        if isinstance(rig.source, GltfSource):
            return _rewritten(rig, path)
        if kind == ".glb":
            return {path: new_glb(rig)}
        raise FileError("a rig that did not come from glTF is saved as .glb, not as .gltf")
    raise FileError(f'a rig cannot be saved as "{kind}"; end the name in {WRITABLE}')


def _rewritten(rig: Rig, path: Path) -> dict[Path, bytes]:
    try:
        return rewritten(rig, path)
    except CutcellError:
        raise
    except (TypeError, ValueError, KeyError, IndexError, AttributeError) as e:
        # Parts of the document that loading had no reason to look at.
        raise FileError(f"its glTF document is malformed ({type(e).__name__}: {e})") from e
