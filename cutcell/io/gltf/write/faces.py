"""Faces of a glTF document that were dropped or turned round: its indices, and the normals."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry import triangles
from ....rig import Rig, TriangleMesh
from ..constants import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER
from ..read.accessors import read_accessor
from ..read.primitives import StoredFaces
from ..read.read import BareSource, GltfSource
from .moves import NewValues


def with_faces(rig: Rig, remaining: NDArray[np.bool_], turned: NDArray[np.bool_]) -> Rig:
    """Return a rig with only faces that are `remaining` (m,), some of them turned round (m,).

    In a glTF document, into which it can still be saved, a primitive keeps one face at least.
    """
    faces = np.where(turned[:, None], rig.mesh.faces[:, [0, 2, 1]], rig.mesh.faces)
    source = rig.source
    if isinstance(source, GltfSource):
        remaining = remaining.copy()
        for stored in source.faces:
            if stored.rows.stop > stored.rows.start and not remaining[stored.rows].any():
                remaining[stored.rows.start] = True
    if isinstance(source, GltfSource | BareSource):
        ends = np.concatenate([[0], np.cumsum(remaining)])
        edited = tuple(_edited(s, remaining, turned, ends) for s in source.faces)
        source = replace(source, faces=edited)
    return replace(rig, mesh=TriangleMesh(rig.mesh.vertices, faces[remaining]), source=source)


def with_rescaled(rig: Rig, vertices: NDArray[np.intp]) -> Rig:
    """Return a rig of which some weights are saved with a sum of one, whatever the file has."""
    source = rig.source
    if not isinstance(source, GltfSource):
        return rig
    before = np.zeros(len(rig.mesh.vertices), bool) if source.rescaled is None else source.rescaled
    rescaled = before.copy()
    rescaled[vertices] = True
    return replace(rig, source=replace(source, rescaled=rescaled))


def _edited(stored: StoredFaces, remaining: NDArray, turned: NDArray, ends: NDArray) -> StoredFaces:
    rows = stored.rows
    is_left, flips = remaining[rows], turned[rows]
    before = stored.turned if stored.turned is not None else np.zeros(len(is_left), bool)
    same = is_left.all() and not flips.any() and stored.turned is None
    return replace(
        stored,
        rows=slice(int(ends[rows.start]), int(ends[rows.stop])),
        turned=None if same else (before ^ flips)[is_left],
    )


def take_faces(document: dict[str, Any], rig: Rig) -> list[NewValues]:
    """Take indices of primitives whose faces changed, and their normals, out of a document."""
    source: GltfSource = rig.source
    replaced: list[NewValues] = []
    for stored in source.faces:
        if stored.turned is None:
            continue
        primitive = document["meshes"][stored.mesh]["primitives"][stored.primitive]
        corners = rig.mesh.faces[stored.rows] - stored.first_vertex
        if stored.is_mirrored:
            corners = corners[:, ::-1]
        small = corners.max() < np.iinfo(np.uint16).max
        numbers = corners.reshape(-1, 1).astype("<u2" if small else "<u4")
        named, old = primitive["attributes"], primitive.pop("indices", None)
        primitive.pop("mode", None)  # triangles
        replaced.append(NewValues(primitive, "indices", numbers, old, ELEMENT_ARRAY_BUFFER))
        normals = _normals(source, named, corners, stored.turned)
        for name, values in normals.items():
            replaced.append(NewValues(named, name, values, named.pop(name), ARRAY_BUFFER))
    return replaced


def _normals(
    source: GltfSource, named: dict[str, int], corners: NDArray, turned: NDArray
) -> dict[str, NDArray]:
    """Return normals that no longer look against turned faces, and tangents with signs to match.

    Exporters that make normals from faces made them inside out as well.
    """
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
