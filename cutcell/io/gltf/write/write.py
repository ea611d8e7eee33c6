"""Writing new weights into a glTF document, joints that were moved, and faces that were mended.

The document's JSON is edited, not made anew: whatever it holds besides these
stays, and so does the number of every object in it, because extensions and extras may
refer to them.
"""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import MeshError, SkeletonError, WeightsError
from ....rig.rig import Rig
from ...materials.gltf_colored import with_surface_colors
from ...materials.gltf_images import carry_images
from ..container import Document, json_bytes, pack_glb
from ..deform import store_deform
from ..read.faces import store_faces, take_faces
from ..read.influences import pack_influences
from ..read.read import GltfSource, StoredPart
from .buffer_file import buffer_file, relative_uri
from .moves import store_moves, take_moves
from .storage import Storage
from .structure import take_structure


def rewritten(rig: Rig, path: Path) -> dict[Path, bytes]:
    """Return the files to write so that a rig's glTF document holds its weights."""
    source: GltfSource = rig.source
    _check_same(rig, source)
    document = json.loads(json.dumps(source.document.json))  # a copy, and quicker than deepcopy
    _rename(document, rig)
    before = [_take_influences(document, part) for part in source.parts]
    dropped = [accessor for old in before for accessor in old.values()]
    faces = take_faces(document, rig)
    dropped += [accessor for new in faces for accessor in new.old.values()]
    parts, moves = take_structure(document, rig, take_moves(document, rig))
    dropped += [new.old for new in moves]
    store_deform(document, ((part.skin, part.joints) for part in parts), rig.skeleton.deform)
    storage = Storage(document, source.document.buffers, dropped)
    store_moves(storage, moves)
    for part, old in zip(parts, before, strict=True):
        _store(storage, document, rig, part, old)
    store_faces(storage, faces)
    storage = with_surface_colors(storage, source.document.surfaces)
    carried = carry_images(storage, source.document, path)
    return {**carried, **packed(storage, source.document, path, carried)}


def _check_same(rig: Rig, source: GltfSource) -> None:
    if rig.weights is None:
        raise WeightsError("the rig has no weights to save; bind it first")
    remedy = "set the rig's source to None to write a new file instead"
    count = source.parts[-1].rows.stop
    if len(rig.mesh.vertices) != count:
        raise MeshError(
            f"the rig has {len(rig.mesh.vertices)} vertices, its document {count}; {remedy}"
        )
    count = source.faces[-1].rows.stop
    if len(rig.mesh.faces) != count:
        raise MeshError(f"the rig has {len(rig.mesh.faces)} faces, its document {count}; {remedy}")
    ours, its = rig.skeleton, source.skeleton
    same = ours.names == its.names and np.array_equal(ours.parents, its.parents)
    if not same and rig.origin is None:
        raise SkeletonError(
            "the rig's joints are no longer those of its document; save it as .npz or .txt, or "
            f"{remedy}"
        )


def _rename(document: dict[str, Any], rig: Rig) -> None:
    """Give nodes the names of joints that were renamed."""
    source, origin = rig.source, rig.origin
    for j, name in enumerate(rig.skeleton.names):
        was = j if origin is None else int(origin[j])
        if was >= 0 and name != source.skeleton.names[was]:
            document["nodes"][source.nodes[was]]["name"] = name


def _take_influences(document: dict[str, Any], part: StoredPart) -> dict[str, int]:
    """Remove JOINTS_n and WEIGHTS_n from a part's primitives and return what they were."""
    taken: dict[str, int] = {}
    for primitive in _primitives(document, part):
        found = primitive["attributes"]
        for name in [k for k in found if k.startswith(("JOINTS_", "WEIGHTS_"))]:
            taken[name] = found.pop(name)
    return taken


def _primitives(document: dict[str, Any], part: StoredPart) -> list[dict[str, Any]]:
    return [document["meshes"][mesh]["primitives"][k] for mesh, k in part.primitives]


def _store(
    storage: Storage, document: dict[str, Any], rig: Rig, part: StoredPart, old: dict[str, int]
) -> None:
    weights = rig.weights[part.rows]  # type: ignore[index]
    _check_reachable(weights, rig, part)
    if part.origin is not None:
        weights = weights[part.origin]
    for n, (where, share) in enumerate(zip(*pack_influences(weights[:, part.joints]), strict=True)):
        joints, shares = f"JOINTS_{n}", f"WEIGHTS_{n}"
        small = len(part.joints) <= 256 and storage.stored_type(old.get(joints)) != np.uint16
        numbers = where.astype("<u1" if small else "<u2")
        new = {
            joints: storage.store(numbers, old.get(joints)),
            shares: storage.store(share.astype("<f4"), old.get(shares)),
        }
        for primitive in _primitives(document, part):
            primitive["attributes"].update(new)


def _check_reachable(weights: NDArray, rig: Rig, part: StoredPart) -> None:
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
    storage: Storage, document: Document, path: Path, carried: dict[Path, bytes]
) -> dict[Path, bytes]:
    """Return the files of a document that was edited, without the images that go along."""
    uris = [buffer.get("uri") for buffer in document.items("buffers")]
    data = storage.finish()
    own = storage.document["buffers"][0] if data else {}
    own.pop("uri", None)
    if path.suffix.lower() != ".gltf":
        return {path: pack_glb(json_bytes(storage.document), data, document.chunks)}
    if uris and all(isinstance(u, str) and u.startswith("data:") for u in uris):
        head = "data:application/octet-stream;base64,"
        own["uri"] = head + base64.b64encode(data).decode()
        return {path: json_bytes(storage.document)}
    file = buffer_file(path, document, carried)
    own["uri"] = relative_uri(file)
    return {file: data, path: json_bytes(storage.document)}
