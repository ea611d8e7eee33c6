"""Loading and saving rigs: ``load(path) -> Rig``, ``save(path, rig)``."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from ..errors import FileError, SkeletonError, WeightsError
from ..rig import Rig
from ..rig.inputs import as_rig
from ..runtime.writing import check_place, write_all
from .articulation import articulation_bytes, read_articulation
from .files import naming, read_bytes
from .gltf.container import ENDINGS, MAGIC, extensions, malformed
from .gltf.read.read import GltfSource, read_gltf
from .gltf.write.fresh import check_fits, new_files
from .gltf.write.skinned import can_be_skinned, skinned
from .gltf.write.write import rewritten
from .inputs import Input, as_file
from .materials.gltf_colored import color_notes
from .meshes.mesh_files import MESHES, read_soup
from .rignet import check_mesh_file, read_rignet, rig_file, rignet_files
from .scenes.document import SCENES, read_scene
from .skeletons import with_skeleton

__all__ = ["load", "save"]

READABLE = (
    "GLB, glTF, VRM, FBX, USD, RigNet (.obj with .txt), Articulation-XL (.npz), or OBJ, PLY, STL, "
    "OFF"
)
EXPORTED = {kind: ("Maya", "FBX") for kind in (".ma", ".mb")} | {".max": ("3ds Max", "FBX")}
"""Programs of formats that only they can read, and what they export."""
WRITABLE = ".glb, .gltf, .vrm, .txt (RigNet, with an .obj) or .npz (Articulation-XL)"
SAVED = (*ENDINGS, ".txt", ".npz")
"""The endings that `save` takes."""
AVATAR = ("VRM", "VRMC_vrm")
"""Extensions of a document that make it a VRM."""


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
    if kind == ".npz":
        return read_articulation(path)
    if kind == ".txt":
        return read_rignet(path)
    if kind in MESHES:
        rig = rig_file(path) if kind == ".obj" and not bare else None
        return read_rignet(rig) if rig else read_soup(path, bare)
    if kind in SCENES:
        return read_scene(path, accessories)
    if kind in ENDINGS or read_bytes(path)[:4] == MAGIC:
        return read_gltf(path, accessories, bare)
    if kind == ".json":
        raise FileError("is not a mesh; give the mesh that this skeleton stands beside")
    program, exported = EXPORTED.get(kind, ("Blender", "GLB"))
    hint = f"from {program}: export as {exported}"
    raise FileError(f'"{kind}" cannot be read; give {READABLE} ({hint})')


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
        kind = path.suffix.lower()
        if kind == ".txt":
            files = rignet_files(path, rig)
        elif kind == ".npz":
            files = {path: articulation_bytes(rig)}
        else:
            _check_gltf(kind, rig)
            files = _gltf_files(rig, path)
        write_all(files)
        return tuple(files)


def check_output(path: Path, rig: Rig | None = None) -> None:
    """Fail early if `save` would fail."""
    kind = path.suffix.lower()
    with naming(path):
        if kind == ".fbx":
            raise FileError(
                f"FBX can be read, not written; save it as {path.stem}.glb, which Blender imports"
            )
        if kind not in SAVED:
            raise FileError(f'a rig cannot be saved as "{path.suffix}"; end the name in {WRITABLE}')
        check_place(path)
        if rig is None or kind == ".npz":
            return
        if kind == ".txt":
            check_mesh_file(path, rig.mesh)
            return
        _check_gltf(kind, rig)
        if isinstance(rig.source, GltfSource) or can_be_skinned(rig):
            none = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.joints)))
            _gltf_files(rig.with_weights(none), path)


def saving_notes(path: Path, rig: Rig) -> tuple[str, ...]:
    """Say what `save` leaves out of the colours of a rig's file, in sentences."""
    if path.suffix.lower() not in ENDINGS or keeps_document(rig):
        return ()
    return color_notes(rig)


def binary_ending(rig: Rig) -> str:
    """Return the ending of a rig as one binary glTF file: an avatar stays ".vrm"."""
    is_vrm = is_avatar(rig) and rig.source.document.path.suffix.lower() == ".vrm"
    return ".vrm" if is_vrm else ".glb"


def is_avatar(rig: Rig) -> bool:
    """Return whether a rig is saved with the extensions that make its document a VRM."""
    if not isinstance(rig.source, GltfSource):
        return False
    return not extensions(rig.source.document.json).keys().isdisjoint(AVATAR)


def keeps_document(rig: Rig) -> bool:
    """Return whether a rig is saved as the glTF document that it came from, materials and all."""
    source = rig.source
    if isinstance(source, GltfSource):
        return source.document.path.suffix.lower() in ENDINGS  # not made of an FBX or USD file
    return can_be_skinned(rig)


def _check_gltf(kind: str, rig: Rig) -> None:
    """Refuse what a rig cannot become: an avatar, or numbers of 32 bits."""
    if kind == ".vrm" and not is_avatar(rig):
        raise FileError(
            f"{rig.name} is no VRM: its file has neither of the extensions {' and '.join(AVATAR)}; "
            "save it as .glb, and make an avatar of that in a program for VRM"
        )
    if not isinstance(rig.source, GltfSource):
        check_fits(rig)


def _gltf_files(rig: Rig, path: Path) -> dict[Path, bytes]:
    if rig.weights is None:
        raise WeightsError("the rig has no weights to save; bind it first")
    with malformed():  # parts of the document that loading had no reason to look at
        if isinstance(rig.source, GltfSource):
            return rewritten(rig, path)
        return skinned(rig, path) if can_be_skinned(rig) else new_files(rig, path)
