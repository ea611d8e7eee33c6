"""Base colours, normals and texture coordinates for a glTF document that cutcell made itself."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...rig import Rig
from ..gltf.buffer import BufferWriter
from ..gltf.constants import ELEMENT_ARRAY_BUFFER
from ..gltf.container import Document
from ..gltf.influences import is_influence
from ..gltf.read.accessors import find_accessor
from .face_colors import Collected, FaceColors, Materials, face_colors
from .gltf_palette import Group, Palette, image_notes
from .surfaces import Corners, Surfaces, join_corners, paint_surface
from .transfer import has_materials, read_corners, read_materials

_Look: TypeAlias = tuple[FaceColors | None, Corners]


def with_rig_looks(document: dict[str, Any], data: bytes, rig: Rig) -> BufferWriter:
    """Give a new document the base colours of a rig's file, its normals and texture coordinates."""
    materials = read_materials(rig) if has_materials(rig) else None
    corners = read_corners(rig)
    if materials is None:
        return _with_looks(document, data, {0: (None, corners)}, Collected())
    looks = {k: (one, Corners()) for k, one in enumerate(materials.attachments, start=1)}
    return _with_looks(document, data, {0: (materials.body, corners), **looks}, materials)


def with_surface_looks(buffer: BufferWriter, surfaces: Surfaces | None) -> BufferWriter:
    """Give a document that was made of another format what that file gives its faces."""
    if surfaces is None:
        return buffer
    document, data = buffer.document, buffer.finish()
    collected = Collected(surfaces.notes)
    paint = partial(paint_surface, surfaces, collected)
    view = Document(surfaces.path, document, [data])
    looks: dict[int, _Look] = {}
    for number, surface in surfaces.meshes.items():
        (primitive,) = document["meshes"][number]["primitives"]
        vertices = _raw(view, primitive["attributes"]["POSITION"])
        faces = _faces(view, number)
        everything = slice(0, len(faces))
        colors = None
        if surfaces.coloured and surface.is_painted:
            colors = face_colors(faces, [(surface, 0, everything)], paint)
        corners = join_corners(vertices, faces, [(surface, faces, everything, np.eye(4))])
        looks[number] = colors, corners
    return _with_looks(document, data, looks, collected)


def color_notes(rig: Rig) -> tuple[str, ...]:
    """Say what a new document cannot hold of the base colours of a rig's file."""
    if not has_materials(rig):
        return ()
    materials = read_materials(rig)
    if materials is None:
        return ("its materials are not saved: its faces are no longer those of its file",)
    return (*materials.notes, *image_notes(materials.images))


class _Mesh(NamedTuple):
    """The new arrays of a mesh with one primitive."""

    old: dict[str, int]
    """The accessors that are given up: "indices", the weights', other attributes' if vertices were
    split."""
    arrays: dict[str, NDArray]  # by attribute, of all vertices; weights are last
    faces: NDArray[np.intp]  # (m, 3)
    groups: list[Group]  # empty where the mesh keeps the plain material
    has_places: bool  # whether all groups have texture coordinates


def _with_looks(
    document: dict[str, Any], data: bytes, looks: Mapping[int, _Look], uses: Materials | Collected
) -> BufferWriter:
    """Return the writer of a document of one primitive a mesh; weights are last, as on saving."""
    view, palette = Document(Path(), document, [data]), Palette(uses)
    numbers = range(len(document["meshes"]))
    new_meshes = [_take(view, k, looks.get(k, (None, Corners())), palette) for k in numbers]
    buffer = BufferWriter(document, [data], [i for mesh in new_meshes for i in mesh.old.values()])
    plain = palette.store(buffer)
    for mesh, new in zip(document["meshes"], new_meshes, strict=True):
        _store(buffer, mesh["primitives"], new, plain)
    for mesh, new in zip(document["meshes"], new_meshes, strict=True):
        weights = filter(is_influence, new.arrays)
        stored = {name: buffer.store(new.arrays[name], new.old[name]) for name in weights}
        for primitive in mesh["primitives"]:
            primitive["attributes"].update(stored)
    if all(mesh.groups for mesh in new_meshes):
        document["materials"].pop()
    return buffer


def _take(view: Document, number: int, look: _Look, palette: Palette) -> _Mesh:
    """Remove from a mesh the data that is stored again."""
    (primitive,) = view.json["meshes"][number]["primitives"]
    named = primitive["attributes"]
    count = view.json["accessors"][named["POSITION"]]["count"]
    faces, origin = _faces(view, number).astype(np.intp), np.arange(count)
    old: dict[str, int] = {}
    arrays: dict[str, NDArray] = {}
    colors, (normals, places) = look
    groups, values = palette.groups(colors) if colors is not None else ([], None)
    columns = [] if values is None else [values]
    if places is not None:
        uv = places + 0.0  # -0 is 0
        for group in groups:  # an image may be placed, or have other coordinates
            if group.textured and values is not None:
                uv[group.rows] = values[group.rows, :, :2]
        columns.append(uv)
    columns += [] if normals is None else [normals]
    if columns:
        faces, origin = split_at_seams(faces, count, np.concatenate(columns, axis=2))
        of_vertex = [_per_vertex(faces, one, len(origin)) for one in columns]
        if normals is not None:
            arrays["NORMAL"] = of_vertex.pop()
            arrays["NORMAL"][~arrays["NORMAL"].any(axis=1), 1] = 1  # no face has the vertex
        if places is not None:
            arrays["TEXCOORD_0"] = of_vertex.pop()
        colored = {}
        if any(group.textured for group in groups):
            colored["TEXCOORD_0"] = of_vertex[0][:, :2].astype("<f4")
        if any(group.varied for group in groups):
            colored["COLOR_0"] = of_vertex[0][:, 2:].astype("<u2")
        arrays = colored | arrays
        old["indices"] = primitive.pop("indices")
    is_split = len(origin) > count
    for name in sorted(named, key=is_influence):
        if is_split or is_influence(name) or name in arrays:
            old[name] = named.pop(name)
            if name not in arrays:
                arrays[name] = _raw(view, old[name])[origin]
    return _Mesh(old, arrays, faces, groups, places is not None)


def _per_vertex(faces: NDArray, values: NDArray[np.float32], count: int) -> NDArray[np.float32]:
    """Return values of corners by vertex, zero where no face has it; (m, 3, k) to (count, k)."""
    of_vertex = np.zeros((count, values.shape[2]), np.float32)
    of_vertex[faces] = values
    return of_vertex


def split_at_seams(faces: NDArray, count: int, values: NDArray) -> tuple[NDArray, NDArray]:
    """Split vertices by their corners' values (m, 3, k); return faces, and origins (count + s,)."""
    corner = faces.reshape(-1).astype(np.intp)
    keys = values.reshape(len(corner), -1)
    order = np.lexsort((*keys.T, corner))
    ordered, at = keys[order], corner[order]
    new = np.ones(len(order), bool)
    new[1:] = (at[1:] != at[:-1]) | (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.empty(len(order), np.intp)
    group[order] = np.cumsum(new) - 1
    first = order[new]  # the sort is stable: the first corner of each group
    vertex = corner[first]
    ranked = np.lexsort((first, vertex))
    leads = np.ones(len(ranked), bool)
    leads[1:] = vertex[ranked][1:] != vertex[ranked][:-1]
    copies = ranked[~leads]
    number = vertex.copy()
    number[copies] = count + np.arange(len(copies))
    return number[group].reshape(-1, 3), np.concatenate([np.arange(count), vertex[copies]])


def _store(buffer: BufferWriter, primitives: list[dict[str, Any]], mesh: _Mesh, plain: int) -> None:
    """Store all of a mesh but its weights; its primitives have their vertices in common."""
    (primitive,) = primitives
    primitive["material"] = plain
    if "indices" not in mesh.old:
        return
    named = primitive["attributes"]
    for name, values in mesh.arrays.items():
        if not is_influence(name):
            named[name] = buffer.store(
                values, mesh.old.get(name), bounds=name == "POSITION", normalized=name == "COLOR_0"
            )
    count = buffer.accessors[named["POSITION"]]["count"]
    kind = "<u2" if count < np.iinfo(np.uint16).max else "<u4"
    primitives.clear()
    everything = Group(plain, np.arange(len(mesh.faces)), mesh.has_places, varied=False)
    for k, group in enumerate(mesh.groups or [everything]):
        corners = mesh.faces[group.rows].reshape(-1, 1).astype(kind)
        old = None if k else mesh.old["indices"]
        uses = {"TEXCOORD_0": group.textured or mesh.has_places, "COLOR_0": group.varied}
        primitives.append({
            **primitive,
            "attributes": {name: at for name, at in named.items() if uses.get(name, True)},
            "indices": buffer.store(corners, old, ELEMENT_ARRAY_BUFFER),
            "material": group.material,
        })  # fmt: skip


def _faces(view: Document, number: int) -> NDArray[np.int32]:
    (primitive,) = view.json["meshes"][number]["primitives"]
    return _raw(view, primitive["indices"]).reshape(-1, 3).astype(np.int32)


def _raw(view: Document, number: int) -> NDArray:
    """Return an accessor's elements as they are stored."""
    kind = view.json["accessors"][number]["type"]
    return find_accessor(view, number, kind, "the document").stored
