"""Base colours for a glTF document that cutcell made itself, with one plain material."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pygltflib
from numpy.typing import NDArray

from ...rig import Rig
from ..gltf.buffer import BufferWriter
from ..gltf.container import Document
from ..gltf.read.accessors import find_accessor
from .face_colors import Collected, FaceColors, face_colors
from .gltf_images import image_notes
from .gltf_palette import Group, Palette, Uses, attributes_of
from .surfaces import SurfacePaint, Surfaces
from .transfer import has_materials, read_materials


def with_rig_colors(document: dict[str, Any], data: bytes, rig: Rig) -> BufferWriter | None:
    """Give a new document the base colours of a rig's file."""
    materials = read_materials(rig) if has_materials(rig) else None
    if materials is None:
        return None
    meshes = dict(enumerate([materials.body, *materials.attachments]))
    return _colored(
        document, data, meshes, Uses(materials.layers, materials.images, materials.names)
    )


def with_surface_colors(buffer: BufferWriter, surfaces: Surfaces | None) -> BufferWriter:
    """Give a document that was made of another format the base colours of that file."""
    if surfaces is None or not surfaces.coloured:
        return buffer
    document, data = buffer.document, buffer.finish()
    collected = Collected(surfaces.notes)
    paint = SurfacePaint(surfaces, collected)
    view = Document(surfaces.path, document, [data])
    meshes = {}
    for number, surface in surfaces.meshes.items():
        faces = _faces(view, number)
        piece = surface, 0, slice(0, len(faces))
        colors = face_colors(faces, [piece], paint)
        if colors is not None:
            meshes[number] = colors
    return _colored(
        document, data, meshes, Uses(list(collected.layers), collected.images, collected.names)
    )


def color_notes(rig: Rig) -> tuple[str, ...]:
    """Say what a new document cannot hold of the base colours of a rig's file."""
    if not has_materials(rig):
        return ()
    materials = read_materials(rig)
    if materials is None:
        return ("its materials are not saved: its faces are no longer those of its file",)
    return (*materials.notes, *image_notes(materials.images))


class _Mesh(NamedTuple):
    """The new arrays of a mesh with one primitive.

    Parameters
    ----------
    old : dict of str to int
        The accessors that are given up: "indices", the weights', other attributes' if vertices
        were split.
    arrays : dict of str to array
        By attribute, of all vertices; weights are last.
    faces : array, shape (m, 3)
    groups : list of Group
        Empty where the mesh keeps the plain material.
    """

    old: dict[str, int]
    arrays: dict[str, NDArray]
    faces: NDArray[np.intp]
    groups: list[Group]


def _colored(
    document: dict[str, Any], data: bytes, meshes: Mapping[int, FaceColors], uses: Uses
) -> BufferWriter:
    """Return the writer of a document each of whose meshes has one primitive.

    Weights are stored behind all else, as they are when the document is read and saved again.
    """
    view, palette = Document(Path(), document, [data]), Palette(uses)
    count = len(document["meshes"])
    new_meshes = [_take(view, number, meshes.get(number), palette) for number in range(count)]
    buffer = BufferWriter(document, [data], [i for mesh in new_meshes for i in mesh.old.values()])
    plain = palette.store(buffer)
    for mesh, new in zip(document["meshes"], new_meshes, strict=True):
        _store(buffer, mesh["primitives"], new, plain)
    for mesh, new in zip(document["meshes"], new_meshes, strict=True):
        weights = {name: values for name, values in new.arrays.items() if _is_weight(name)}
        stored = {name: buffer.store(weights[name], new.old[name]) for name in weights}
        for primitive in mesh["primitives"]:
            primitive["attributes"].update(stored)
    if all(mesh.groups for mesh in new_meshes):
        document["materials"].pop()
    return buffer


def _take(view: Document, number: int, colors: FaceColors | None, palette: Palette) -> _Mesh:
    """Take out of a mesh what is to be stored anew."""
    (primitive,) = view.json["meshes"][number]["primitives"]
    named = primitive["attributes"]
    count = view.json["accessors"][named["POSITION"]]["count"]
    faces, origin = _faces(view, number).astype(np.intp), np.arange(count)
    old: dict[str, int] = {}
    arrays: dict[str, NDArray] = {}
    groups: list[Group] = []
    if colors is not None:
        groups, values = palette.groups(colors)
        faces, origin = split_at_seams(faces, count, values)
        of_vertex = np.zeros((len(origin), values.shape[2]), np.float32)
        of_vertex[faces] = values
        arrays |= attributes_of(groups, of_vertex)
        old["indices"] = primitive.pop("indices")
    is_split = len(origin) > count
    for name in sorted(named, key=_is_weight):
        if is_split or _is_weight(name):
            old[name] = named.pop(name)
            arrays[name] = _raw(view, old[name])[origin]
    return _Mesh(old, arrays, faces, groups)


def split_at_seams(
    faces: NDArray[np.integer], count: int, values: NDArray[np.float32]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Split vertices whose corners have different values.

    Shapes: faces (m, 3), values (m, 3, k); returns faces (m, 3), origin (count + s,).
    """
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
    if not mesh.groups:
        primitive["material"] = plain
        return
    named = primitive["attributes"]
    for name, values in mesh.arrays.items():
        if _is_weight(name):
            continue
        number = named[name] = buffer.store(values, mesh.old.get(name))
        if name == "POSITION":
            low, high = values.min(axis=0).tolist(), values.max(axis=0).tolist()
            buffer.accessors[number].update(min=low, max=high)
        elif name == "COLOR_0":
            buffer.accessors[number]["normalized"] = True
    count = buffer.accessors[named["POSITION"]]["count"]
    kind = "<u2" if count < np.iinfo(np.uint16).max else "<u4"
    primitives.clear()
    for k, group in enumerate(mesh.groups):
        corners = mesh.faces[group.rows].reshape(-1, 1).astype(kind)
        uses = {"TEXCOORD_0": group.textured, "COLOR_0": group.varied}
        primitives.append({
            **primitive,
            "attributes": {name: at for name, at in named.items() if uses.get(name, True)},
            "indices": buffer.store(
                corners, None if k else mesh.old["indices"], pygltflib.ELEMENT_ARRAY_BUFFER
            ),
            "material": group.material,
        })  # fmt: skip


def _is_weight(name: str) -> bool:
    return name.startswith(("JOINTS_", "WEIGHTS_"))


def _faces(view: Document, number: int) -> NDArray[np.int32]:
    (primitive,) = view.json["meshes"][number]["primitives"]
    return _raw(view, primitive["indices"]).reshape(-1, 3).astype(np.int32)


def _raw(view: Document, number: int) -> NDArray:
    """Return an accessor's elements as they are stored."""
    kind = view.json["accessors"][number]["type"]
    return find_accessor(view, number, kind, "the document").base.array()
