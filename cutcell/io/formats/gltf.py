"""glTF 2.0, and avatars in VRM."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ...errors import FileError, WeightsError
from ...rig import Rig
from ..gltf.buffer import ranges_in
from ..gltf.container import extensions, malformed
from ..gltf.nodes import Nodes
from ..gltf.read.compressed import plain_document
from ..gltf.read.parts import unread
from ..gltf.read.read import GltfSource, read_bare, read_rig, skinned_nodes
from ..gltf.write.new import can_be_skinned, check_fits, new_files, skinned
from ..gltf.write.write import rewritten
from ..skeletons import SkeletonFile, of_document

SUFFIXES = {".glb": rb"glTF", ".gltf": rb"\s*\{", ".vrm": rb"glTF"}
NOTE = ""
AVATAR = ("VRM", "VRMC_vrm")
"""Extensions of a document that make it a VRM."""


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load a rig."""
    with malformed():
        document = plain_document(path)
        if bare and not skinned_nodes(Nodes(document)):
            rig = read_bare(document, Nodes(document))
        else:
            rig = read_rig(document, accessories=accessories)
        many = ("accessors", "animations")  # which name buffers by views
        rest = {key: value for key, value in document.json.items() if key not in many}
        for owner in ranges_in(rest):  # saving copies them
            document.view_range(owner, "a buffer view")
        return replace(rig, warnings=(*unread(document), *rig.warnings))


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the joints of the skins of a document, else its bones, and the clips."""
    with malformed():
        return of_document(plain_document(path))


def write(path: Path, rig: Rig) -> dict[Path, bytes]:
    """Return the files to write for a rig, `path` last."""
    _check_kind(path, rig)
    if rig.weights is None:
        raise WeightsError("the rig has no weights to save; bind it first")
    with malformed():  # parts of the document that loading had no reason to look at
        if isinstance(rig.source, GltfSource):
            return rewritten(rig, path)
        return skinned(rig, path) if can_be_skinned(rig) else new_files(rig, path)


def check(path: Path, rig: Rig) -> None:
    """Refuse what `write` would refuse, whatever its weights will be."""
    _check_kind(path, rig)
    if isinstance(rig.source, GltfSource) or can_be_skinned(rig):
        none = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.joints)))
        write(path, rig.with_weights(none))


def _check_kind(path: Path, rig: Rig) -> None:
    """Refuse what a rig cannot become: an avatar, or numbers of 32 bits."""
    if path.suffix.lower() == ".vrm" and not is_avatar(rig):
        raise FileError(
            f"{rig.name} is no VRM: its file has neither of the extensions {' and '.join(AVATAR)}; "
            "save it as .glb, and make an avatar of that in a program for VRM"
        )
    if not isinstance(rig.source, GltfSource):
        check_fits(rig)


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
    return source.document.is_gltf if isinstance(source, GltfSource) else can_be_skinned(rig)
