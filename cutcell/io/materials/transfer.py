"""Base colours, normals and texture coordinates that a rig's file gives it, of any format."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import CutcellError
from ...rig import Rig
from ..gltf.container import Document
from ..gltf.read.primitives import Primitive, StoredFaces, primitives, read_triangles
from ..gltf.read.read import BareSource, GltfSource
from .face_colors import Collected, Materials, Paint, face_colors
from .gltf_materials import is_coloured, paint_primitive
from .obj_materials import ObjSource
from .surfaces import Corners, Piece, Surface, Surfaces, join_corners, paint_surface

BYTES_PER_FACE = 3 * (4 * 4 + 4)


def has_materials(rig: Rig) -> bool:
    """Return whether a rig's file colours it: by an image, by vertex, or not in one grey alone."""
    document, surfaces = _file(rig)
    if surfaces is not None:
        return surfaces.coloured
    if document is None:
        return False
    drawn = [primitive for primitive, _, _ in _of_body(document, rig.source)]
    for node in getattr(rig.source, "attached", ()):
        mesh = document.items("nodes")[node]["mesh"]
        drawn += primitives(document, mesh)
    return is_coloured(drawn)


def read_materials(rig: Rig) -> Materials | None:
    """Return the base colours that a rig's file gives it, with notes on what is unreadable."""
    document, surfaces = _file(rig)
    meshes: list[tuple[NDArray, Iterable[tuple[Any, int, slice]]]]
    if document is not None:
        attached = getattr(rig.source, "attached", ())
        if len(attached) != len(rig.attachments):
            return None
        # Its own store of what was decoded: others may read the same document now, or forget.
        document = replace(document, warnings=[])
        meshes = [(rig.mesh.faces, _of_body(document, rig.source))]
        for one, node in zip(rig.attachments, attached, strict=True):
            meshes.append((one.mesh.faces, _of_node(document, node)))
        face_count = sum(len(faces) for faces, _ in meshes)
        document.allowance.take(face_count * BYTES_PER_FACE, "its materials")
    elif surfaces is not None and any(one.is_painted for one in surfaces.meshes.values()):
        everything = slice(0, len(rig.mesh.faces))
        meshes = [(rig.mesh.faces, [(one, 0, everything) for one in surfaces.meshes.values()])]
    else:
        return None
    collected = Collected(() if surfaces is None else surfaces.notes)
    paint: Paint = partial(paint_primitive, collected)
    if surfaces is not None:
        paint = partial(paint_surface, surfaces, collected)
    colors = [face_colors(faces, pieces, paint) for faces, pieces in meshes]
    whole = tuple(one for one in colors if one is not None)
    if len(whole) < len(colors):
        return None
    layers, images = tuple(collected.layers), tuple(collected.images)
    notes, names = tuple(collected.notes), tuple(collected.names)
    return Materials(whole[0], whole[1:], layers, images, notes, names)


def read_corners(rig: Rig) -> Corners:
    """Return normals and texture coordinates of a body's corners, unless its document has them."""
    (document, surfaces), faces = _file(rig), rig.mesh.faces
    pieces: list[Piece] = []
    if document is None and surfaces is not None:
        everything = slice(0, len(faces))
        pieces = [(one, faces, everything, np.eye(4)) for one in surfaces.meshes.values()]
    elif isinstance(rig.source, BareSource):
        for one in rig.source.faces:
            if one.rows.stop > len(faces):  # the mesh is another one
                return Corners()
            surface = _stored_surface(rig.source.document, one)
            if surface is not None:
                triangles = faces[one.rows] - one.first_vertex
                pieces.append((surface, triangles, one.rows, rig.source.placed[one.node]))
    return join_corners(rig.mesh.vertices, faces, pieces)


def _stored_surface(document: Document, one: StoredFaces) -> Surface | None:
    """Return what the file of a document stores of the faces of a primitive."""
    if document.surfaces is not None:
        return document.surfaces.meshes.get(one.mesh)
    primitive = primitives(document, one.mesh)[one.primitive]
    faces, corners = primitive.faces(), dict[str, Any]()
    for key, name, kind in (("normals", "NORMAL", "VEC3"), ("places", "TEXCOORD_0", "VEC2")):
        if name in primitive.attributes:
            with suppress(CutcellError):
                values = primitive.accessor(name, kind).values
                corners[key] = np.asarray(values, np.float32)[faces]
    return Surface(faces.astype(np.int32), np.full(len(faces), -1, np.int32), **corners)


def _file(rig: Rig) -> tuple[Document | None, Surfaces | None]:
    """Return the document that a rig came from, and the surfaces of a file that was no glTF."""
    source = rig.source
    if isinstance(source, GltfSource | BareSource):
        return source.document, source.document.surfaces
    if isinstance(source, ObjSource):
        return None, source.surfaces
    return None, source if isinstance(source, Surfaces) else None


def _of_body(
    document: Document, source: GltfSource | BareSource
) -> Iterator[tuple[Any, int, slice]]:
    for one in source.faces:
        primitive = primitives(document, one.mesh)[one.primitive]
        yield _what(document, one.mesh, primitive), one.first_vertex, one.rows


def _of_node(document: Document, number: int) -> Iterator[tuple[Any, int, slice]]:
    mesh = document.items("nodes")[number]["mesh"]
    drawn = read_triangles(document, mesh, document.label("nodes", number))[2]
    for primitive, first, rows in drawn:
        yield _what(document, mesh, primitive), first, rows


def _what(document: Document, mesh: int, primitive: Primitive) -> Any:
    """Return what colours a primitive: it, or a surface of the format that it was made of."""
    return primitive if document.surfaces is None else document.surfaces.meshes.get(mesh)
