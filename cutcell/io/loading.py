"""Rigs from files of any format, and to files."""

from __future__ import annotations

import os
from pathlib import Path

from ..errors import FileError, SkeletonError
from ..rig import Rig
from ..rig.inputs import as_rig
from ..runtime.writing import check_place, write_all
from .files import Input, as_file, naming, read_bytes
from .formats import BY_SUFFIX, GLTF, described, suffixes
from .formats.gltf import keeps_document
from .gltf.container import MAGIC
from .materials.gltf_colored import color_notes
from .skeletons import with_skeleton

EXPORTED = {kind: ("Maya", "FBX") for kind in (".ma", ".mb")} | {".max": ("3ds Max", "FBX")}
"""Programs of formats that only they can read, and what they export."""


def load(path: Input, skeleton: Input | None = None, accessories: bool = False) -> Rig:
    """Load a rig.

    Parameters
    ----------
    path : path, bytes or open file
        A GLB, glTF, VRM, FBX or USD file; RigNet's ``.obj`` or ``.txt``; an Articulation-XL
        ``.npz``; or a mesh (OBJ, PLY, STL, OFF) with a skeleton in a JSON file beside it. A mesh
        without a skeleton becomes a rig without joints. ``docs/formats.md`` says what is taken
        from each. The format of bytes, of a file opened in binary mode and of a pipe is that of
        their content.
    skeleton : path, bytes or open file, optional
        A file with the skeleton of a mesh that has no skin: JSON, GLB, glTF, VRM, FBX, USD,
        RigNet's ``.txt`` or Articulation-XL's ``.npz``. Its clips come with it.
    accessories : bool
        Whether meshes of a glTF, FBX or USD file that have no skin, such as a sword on a joint,
        become part of the rig's mesh, to be bound with it.

    Returns
    -------
    Rig
        Vertices in the file's order; weights where the file has any.

    Raises
    ------
    FileError
        No such file, not what its name says, or damaged.
    MeshError, SkeletonError, WeightsError
        What the file holds cannot be used, or it has a skeleton besides the one that is given.
        Every message names the file.
    """
    with as_file(path) as file, naming(file):
        rig = _load(file, skeleton is not None, accessories)
        if skeleton is None:
            return rig
        if len(rig.skeleton.joints):
            raise SkeletonError(
                f"has a skeleton of its own, of {len(rig.skeleton.joints)} joints; a skeleton file "
                "is for a mesh without one"
            )
        with as_file(skeleton) as donor:
            return with_skeleton(rig, donor)


def _load(path: Path, bare: bool, accessories: bool) -> Rig:
    """Load a rig; if `bare`, without a skeleton that is no part of a skin."""
    kind = path.suffix.lower()
    if kind not in BY_SUFFIX and read_bytes(path)[:4] == MAGIC:
        kind = ".glb"
    if kind not in BY_SUFFIX:
        program, exported = EXPORTED.get(kind, ("Blender", "GLB"))
        hint = f"from {program}: export as {exported}"
        raise FileError(f'"{kind}" cannot be read; give {described("read")} ({hint})')
    if kind not in suffixes("read"):
        raise FileError("is not a mesh; give the mesh that this skeleton stands beside")
    return BY_SUFFIX[kind].module.read(path, accessories, bare)


def save(path: str | os.PathLike[str], rig: Rig) -> tuple[Path, ...]:
    """Save a rig.

    A rig that was loaded from glTF goes back into its own document, in which only the skin
    weights change, and what joints that were moved take (`Rig.with_joints`). So does a mesh from
    glTF that had no skeleton, with the one that it was given. Another rig becomes a new document,
    with the base colours of its file (`saving_notes` says what is missing of them). All
    files are written whole or not at all:
    a failure leaves what was there, and a rig may be saved over the file it came from. A file
    that is not named here, such as the mesh or the buffer beside it, is never replaced if
    it is another's; ``docs/formats.md`` says how.

    Parameters
    ----------
    path : path
        Ends in ``.glb``, ``.gltf``, ``.vrm``, ``.txt`` (RigNet, with the mesh as an ``.obj``
        beside it) or ``.npz`` (Articulation-XL).
    rig : Rig

    Returns
    -------
    tuple of Path
        The files that were written, `path` last.

    Raises
    ------
    FileError
        Another ending, ``.vrm`` for a rig that is not from a VRM, or the file cannot be written.
    MeshError, SkeletonError
        The rig has no joints; or its mesh or joints are no longer those of its glTF document; or
        joints were moved of a skin without inverse bind matrices; or they do not fit in a new GLB,
        whose numbers have 32 bits.
    WeightsError
        The rig has no weights, or some that its glTF document cannot hold.
    """
    path, rig = Path(path), as_rig(rig)
    with naming(path):
        rig.require_joints()
        check_output(path)
        files = BY_SUFFIX[path.suffix.lower()].module.write(path, rig)
        write_all(files)
        return tuple(files)


def check_output(path: Path, rig: Rig | None = None) -> None:
    """Fail early if `save` would fail."""
    with naming(path):
        kind = path.suffix.lower()
        if kind not in suffixes("write"):
            raise FileError(
                f'a rig cannot be saved as "{path.suffix}"; end the name in {described("write")}'
            )
        check_place(path)
        if rig is not None and kind in suffixes("check"):
            BY_SUFFIX[kind].module.check(path, rig)


def saving_notes(path: Path, rig: Rig) -> tuple[str, ...]:
    """Say what `save` leaves out of the colours of a rig's file, in sentences."""
    if path.suffix.lower() not in GLTF or keeps_document(rig):
        return ()
    return color_notes(rig)
