"""Faces of a glTF document that were dropped or turned round: its indices, and the normals."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry import triangles
from ....rig import Rig, TriangleMesh
from ..buffer import BufferWriter
from ..constants import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, TRIANGLES
from ..read.accessors import read_accessor
from ..read.primitives import StoredFaces
from ..read.read import BareSource, GltfSource


def with_faces(rig: Rig, kept: NDArray[np.bool_], turned: NDArray[np.bool_]) -> Rig:
    """Return a rig with some faces dropped and some turned round.

    One that came from glTF can still be saved into its document. There a primitive keeps one
    face at least: it may not be empty.

    Shapes: kept, turned (m,).
    """
    faces = np.where(turned[:, None], rig.mesh.faces[:, [0, 2, 1]], rig.mesh.faces)
    source = rig.source
    if isinstance(source, GltfSource):
        kept = kept.copy()
        for stored in source.faces:
            if stored.rows.stop > stored.rows.start and not kept[stored.rows].any():
                kept[stored.rows.start] = True
    if isinstance(source, GltfSource | BareSource):
        ends = np.concatenate([[0], np.cumsum(kept)])
        source = replace(source, faces=tuple(_edited(s, kept, turned, ends) for s in source.faces))
    return replace(rig, mesh=TriangleMesh(rig.mesh.vertices, faces[kept]), source=source)


def with_rescaled(rig: Rig, vertices: NDArray[np.intp]) -> Rig:
    """Return a rig of which some weights are saved with a sum of one, whatever the file has."""
    source = rig.source
    if not isinstance(source, GltfSource):
        return rig
    rescaled = np.zeros(len(rig.mesh.vertices), bool)
    if source.rescaled is not None:
        rescaled |= source.rescaled
    rescaled[vertices] = True
    return replace(rig, source=replace(source, rescaled=rescaled))


def _edited(
    stored: StoredFaces, kept: NDArray[np.bool_], turned: NDArray[np.bool_], ends: NDArray[np.intp]
) -> StoredFaces:
    rows = stored.rows
    is_left, flips = kept[rows], turned[rows]
    before = stored.turned if stored.turned is not None else np.zeros(len(is_left), bool)
    same = is_left.all() and not flips.any() and stored.turned is None
    return replace(
        stored,
        rows=slice(int(ends[rows.start]), int(ends[rows.stop])),
        turned=None if same else (before ^ flips)[is_left],
    )


@dataclass(frozen=True, eq=False)
class NewFaces:
    """The new arrays of a primitive whose faces changed."""

    primitive: dict[str, Any]
    arrays: dict[str, NDArray]  # its "indices", and the attributes that changed with them
    old: dict[str, int]  # the accessors that these replace


def take_faces(document: dict[str, Any], rig: Rig) -> list[NewFaces]:
    """Take the indices of primitives whose faces changed out of a document, to be replaced.

    Normals of vertices that only turned faces use are replaced as well, if they look against
    these.
    """
    source: GltfSource = rig.source
    replaced = []
    for stored in source.faces:
        if stored.turned is None:
            continue
        primitive = document["meshes"][stored.mesh]["primitives"][stored.primitive]
        corners = rig.mesh.faces[stored.rows] - stored.first_vertex
        if stored.is_mirrored:
            corners = corners[:, ::-1]
        small = corners.max() < np.iinfo(np.uint16).max
        numbers = corners.reshape(-1, 1).astype("<u2" if small else "<u4")
        arrays = {"indices": numbers, **_normals(source, primitive, corners, stored.turned)}
        old = {name: primitive["attributes"].pop(name) for name in arrays if name != "indices"}
        if "indices" in primitive:
            old["indices"] = primitive.pop("indices")
        replaced.append(NewFaces(primitive, arrays, old))
    return replaced


def store_faces(buffer: BufferWriter, replaced: list[NewFaces]) -> None:
    """Store what `take_faces` found."""
    for new in replaced:
        for name, values in new.arrays.items():
            is_index = name == "indices"
            owner = new.primitive if is_index else new.primitive["attributes"]
            target = ELEMENT_ARRAY_BUFFER if is_index else ARRAY_BUFFER
            owner[name] = buffer.store(values, new.old.get(name), target)
        new.primitive["mode"] = TRIANGLES


def _normals(
    source: GltfSource,
    primitive: dict[str, Any],
    corners: NDArray[np.int32],
    turned: NDArray[np.bool_],
) -> dict[str, NDArray]:
    """Return normals, and tangents with them, that no longer look against turned faces.

    Exporters that make normals from faces made them inside out as well. Tangents keep their
    direction; the sign of their w follows, so that bumps stay bumps.
    """
    named = primitive["attributes"]
    if "NORMAL" not in named or not turned.any():
        return {}
    positions, normals = (
        read_accessor(source.document, named[name], "VEC3", name).astype(np.float64)
        for name in ("POSITION", "NORMAL")
    )
    facing = triangles.normals(positions[corners[turned]])
    agreement, others = np.zeros(len(positions)), np.zeros(len(positions), bool)
    others[corners[~turned]] = True
    for vertex in corners[turned].T:
        np.add.at(agreement, vertex, np.einsum("ij,ij->i", facing, normals[vertex]))
    wrong = (agreement < 0) & ~others
    if not wrong.any():
        return {}
    arrays = {"NORMAL": np.where(wrong[:, None], -normals, normals).astype("<f4")}
    if "TANGENT" in named:
        tangents = read_accessor(source.document, named["TANGENT"], "VEC4", "TANGENT").copy()
        tangents[wrong, 3] *= -1
        arrays["TANGENT"] = tangents.astype("<f4")
    return arrays
