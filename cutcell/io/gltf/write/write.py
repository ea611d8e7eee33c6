"""Writing new weights into a glTF document, joints that were moved, and faces that were mended.

The document's JSON is edited: everything else in it
stays, and so does the number of every object in it, because extensions and extras may
refer to them.
"""

from __future__ import annotations

import base64
import json
import os
import re
from collections.abc import Collection
from itertools import count
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from ....errors import FileError, MeshError, SkeletonError, WeightsError
from ....rig import Rig
from ...materials.gltf_colored import with_surface_looks
from ...materials.gltf_palette import carry_images
from ..buffer import BufferWriter
from ..constants import ARRAY_BUFFER
from ..container import Document, beside, json_bytes, pack_glb
from ..influences import store_deform, take_influences
from ..read.read import GltfSource, StoredPart
from .faces import take_faces
from .influence_rows import new_influences
from .moves import NewValues, file_joints, take_moves
from .structure import take_structure


def rewritten(rig: Rig, path: Path) -> dict[Path, bytes]:
    """Return the files to write so that a rig's glTF document holds its weights."""
    source: GltfSource = rig.source
    _check_same(rig, source)
    document = json.loads(json.dumps(source.document.json))  # a copy, and quicker than deepcopy
    _rename(document, rig)
    _forget_settings(document)
    faces = take_faces(document, rig)
    parts, moves = take_structure(document, rig, take_moves(document, rig))
    for saved in parts:
        _check_reachable(rig, saved)
    weights, given_up = _take_weights(document, rig, parts)
    store_deform(document, ((part.skin, part.joints) for part in parts), rig.skeleton.deform)
    changes, stored = [*moves, *weights, *faces], dict[Any, int]()
    given_up += [new.old for new in changes if new.old is not None]
    buffer = BufferWriter(document, source.document.buffers, given_up)
    for new in changes:
        new.store(buffer, stored)
    buffer = with_surface_looks(buffer, source.document.surfaces)
    carried = carry_images(buffer, source.document, path)
    return {**carried, **packed(buffer, source.document, path, carried)}


def _take_weights(
    document: dict[str, Any], rig: Rig, parts: list[StoredPart]
) -> tuple[list[NewValues], list[int]]:
    """Take weights that change out of a document; return new ones, and the accessors they had."""
    changes: list[NewValues] = []
    given_up: list[int] = []
    for part, saved in zip(rig.source.parts, parts, strict=True):
        new = new_influences(rig, part, saved)
        if new is None:
            continue
        old: dict[str, int] = {}
        owners = [document["meshes"][m]["primitives"][k]["attributes"] for m, k in saved.primitives]
        for owner in owners:
            old |= take_influences(owner)
        given_up += old.values()
        changes += [
            NewValues(owner, name, values, old.get(name), ARRAY_BUFFER)
            for name, values in new.items()
            for owner in owners
        ]
    return changes, given_up


def _check_same(rig: Rig, source: GltfSource) -> None:
    remedy = "set the rig's source to None to write a new file instead"
    count = source.parts[-1].rows.stop
    if len(rig.mesh.vertices) != count:
        raise MeshError(
            f"the rig has {len(rig.mesh.vertices)} vertices, its document {count}; {remedy}"
        )
    count = source.faces[-1].rows.stop
    if len(rig.mesh.faces) != count:
        raise MeshError(f"the rig has {len(rig.mesh.faces)} faces, its document {count}; {remedy}")
    current, original = rig.skeleton, source.skeleton
    same = current.names == original.names and np.array_equal(current.parents, original.parents)
    if not same and rig.origin is None:
        raise SkeletonError(
            "the rig's joints are no longer those of its document; save it as .npz or .txt, or "
            f"{remedy}"
        )


def _rename(document: dict[str, Any], rig: Rig) -> None:
    """Give nodes the names of joints that were renamed."""
    source = rig.source
    for was, name in zip(file_joints(rig).tolist(), rig.skeleton.names, strict=True):
        if was >= 0 and name != source.skeleton.names[was]:
            document["nodes"][source.nodes[was]]["name"] = name


def _forget_settings(document: dict[str, Any]) -> None:
    """Remove the settings of other weights, which the page writes into a file."""
    extras = document["asset"].get("extras")
    if isinstance(extras, dict):
        extras.pop("cutcell", None)


def _check_reachable(rig: Rig, part: StoredPart) -> None:
    weights = rig.weights[part.rows]  # type: ignore[index]
    outside = np.ones(weights.shape[1], bool)
    outside[part.joints] = False
    rows, columns = np.nonzero(weights * outside)
    if len(rows):
        raise WeightsError(
            f"{part.label}: vertex {rows[0]} has weight on the joint "
            f'"{rig.skeleton.names[columns[0]]}", which the skin of that mesh does not have '
            f"({len(set(rows.tolist()))} vertices are so); keep to the joints in Rig.allowed"
        )


def packed(
    buffer: BufferWriter, document: Document, path: Path, carried: dict[Path, bytes]
) -> dict[Path, bytes]:
    """Return the files of a document that was edited, without the images that go along."""
    uris = [one.get("uri") for one in document.items("buffers")]
    data = buffer.finish()
    buffer_object = buffer.document["buffers"][0] if data else {}
    buffer_object.pop("uri", None)
    if path.suffix.lower() != ".gltf":
        return {path: pack_glb(json_bytes(buffer.document), data, document.chunks)}
    if uris and all(isinstance(u, str) and u.startswith("data:") for u in uris):
        head = "data:application/octet-stream;base64,"
        buffer_object["uri"] = head + base64.b64encode(data).decode()
        return {path: json_bytes(buffer.document)}
    file = buffer_file(path, document, carried)
    buffer_object["uri"] = relative_uri(file)
    return {file: data, path: json_bytes(buffer.document)}


UNFIT = re.compile(r"[\x00-\x1f\x7f:\\\ud800-\udfff]")
"""Characters of file names that a relative URI cannot contain, or `beside` refuses."""


def buffer_file(path: Path, source: Document, reserved: Collection[Path] = ()) -> Path:
    """Return the file for the buffer of a document: NAME.bin, or NAME-2.bin and so on.

    It replaces nothing but the buffer of a document that is replaced.
    """
    replaceable = _buffers_of(path)
    if os.path.realpath(path) != os.path.realpath(source.path):
        replaceable -= {os.path.realpath(file) for file in _files_of(source.path, source.json)}
    stem = UNFIT.sub("_", path.stem)
    for k in count(1):
        choice = path.with_name(f"{stem}.bin" if k == 1 else f"{stem}-{k}.bin")
        free = not os.path.lexists(choice) and choice not in reserved
        if free or os.path.realpath(choice) in replaceable:
            return choice
    raise AssertionError("count ends")


def relative_uri(file: Path) -> str:
    """Return the URI by which a document names a file beside it; letters stay as they are."""
    return "".join(c if ord(c) > 127 else quote(c, safe="!$&'()*+,;=@") for c in file.name)


def _buffers_of(path: Path) -> set[str]:
    """Return the real paths of the buffers of a document, if there is a readable one."""
    try:
        document = json.loads(path.read_bytes())
        return {os.path.realpath(file) for file in _files_of(path, document, ("buffers",))}
    except (OSError, ValueError, RecursionError, FileError):
        return set()


def _files_of(
    path: Path, document: Any, kinds: Collection[str] = ("buffers", "images")
) -> list[Path]:
    """Return the files beside a document that it refers to."""
    files: list[Path | None] = []
    for kind in kinds:
        objects = document.get(kind) if isinstance(document, dict) else None
        for item in objects if isinstance(objects, list) else ():
            uri = item.get("uri") if isinstance(item, dict) else None
            if isinstance(uri, str) and not uri.startswith("data:"):
                files.append(beside(path, uri))
    return [file for file in files if file is not None]
