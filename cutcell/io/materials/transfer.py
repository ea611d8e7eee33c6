"""Base colours, normals and texture coordinates that a rig's file gives it, of any format."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import CutcellError
from ...rig import Rig
from ..gltf.container import Document
from ..gltf.read.accessors import read_accessor
from ..gltf.read.primitives import (
    StoredFaces,
    primitives,
    read_faces,
    read_positions,
    read_triangles,
)
from ..gltf.read.read import BareSource, GltfSource
from .corners import Corners, Piece, join_corners, surface_piece
from .face_colors import Collected, FaceColors, Materials, face_colors
from .gltf_materials import PrimitivePaint, is_coloured
from .obj_materials import ObjSource
from .surfaces import Surface, SurfacePaint, Surfaces

BYTES_PER_FACE = 3 * (4 * 4 + 4)


def has_materials(rig: Rig) -> bool:
    """Return whether a rig's file colours it: by an image, by vertex, or not in one grey alone."""
    source = _source(rig)
    if isinstance(source, Surfaces):
        return source.coloured
    if not isinstance(source, GltfSource | BareSource):
        return False
    if source.document.surfaces is not None:
        return source.document.surfaces.coloured
    nodes, document = source.document.items("nodes"), source.document
    drawn = [primitive for primitive, _, _ in _of_body(document, source)]
    for node in getattr(source, "attached", ()):
        drawn += primitives(document, nodes[node]["mesh"], document.label("nodes", node))
    return is_coloured(document, drawn)


def read_materials(rig: Rig) -> Materials | None:
    """Return the base colours that a rig's file gives it.

    Unreadable images are replaced by the material's factor, or white, with a note.
    """
    source = _source(rig)
    if isinstance(source, Surfaces):
        if not any(surface.is_painted for surface in source.meshes.values()):
            return None
        collected = Collected(source.notes)
        pieces = [(surface, 0, slice(0, len(rig.mesh.faces))) for surface in source.meshes.values()]
        body = face_colors(rig.mesh.faces, pieces, SurfacePaint(source, collected))
        return _complete(body, [], collected)
    if not isinstance(source, GltfSource | BareSource):
        return None
    attached = getattr(source, "attached", ())
    if len(attached) != len(rig.attachments):
        return None
    # Its own store of what was decoded: others may read the same document now, or forget.
    document = replace(source.document, warnings=[])
    surfaces = document.surfaces
    collected = Collected(() if surfaces is None else surfaces.notes)
    paint: Any = PrimitivePaint(document, collected)
    if surfaces is not None:
        paint = SurfacePaint(surfaces, collected)
    face_count = len(rig.mesh.faces) + sum(len(one.mesh.faces) for one in rig.attachments)
    document.allowance.take(face_count * BYTES_PER_FACE, "its materials")
    body = face_colors(rig.mesh.faces, _of_body(document, source), paint)
    hung = [
        face_colors(one.mesh.faces, _of_node(document, node), paint)
        for one, node in zip(rig.attachments, attached, strict=True)
    ]
    return _complete(body, hung, collected)


def read_corners(rig: Rig) -> Corners:
    """Return normals and texture coordinates that a rig's file gives the corners of its body.

    Those of a `GltfSource` remain in its document.
    """
    source, faces = _source(rig), rig.mesh.faces
    pieces: list[Piece | None] = []
    if isinstance(source, Surfaces):
        everything = slice(0, len(faces))
        pieces = [surface_piece(one, faces, everything) for one in source.meshes.values()]
    elif isinstance(source, BareSource):
        for one in source.faces:
            if one.rows.stop > len(faces):  # the mesh is another one
                return Corners()
            surface = _stored_surface(source.document, one)
            if surface is not None:
                own = faces[one.rows] - one.first_vertex
                pieces.append(surface_piece(surface, own, one.rows, source.placed[one.node]))
    return join_corners(rig.mesh.vertices, faces, [one for one in pieces if one is not None])


def _stored_surface(document: Document, one: StoredFaces) -> Surface | None:
    """Return what the file of a document stores of the faces of a primitive."""
    if document.surfaces is not None:
        return document.surfaces.meshes.get(one.mesh)
    primitive = primitives(document, one.mesh, "the document")[one.primitive]
    named, corners = primitive["attributes"], {}
    count = len(read_positions(document, primitive, "the document"))
    faces = read_faces(document, primitive, count, "the document")
    for key, name, kind in (("normals", "NORMAL", "VEC3"), ("places", "TEXCOORD_0", "VEC2")):
        if name in named:
            with suppress(CutcellError):
                values = read_accessor(document, named[name], kind, "the document")
                corners[key] = np.asarray(values, np.float32)[faces]
    return Surface(faces.astype(np.int32), np.full(len(faces), -1, np.int32), **corners)


def _source(rig: Rig) -> Any:
    return rig.source.surfaces if isinstance(rig.source, ObjSource) else rig.source


def _complete(
    body: FaceColors | None, hung: list[FaceColors | None], collected: Collected
) -> Materials | None:
    whole = [colors for colors in hung if colors is not None]
    if body is None or len(whole) < len(hung):
        return None
    found = collected.layers, collected.images, collected.notes, collected.names
    return Materials(body, tuple(whole), *found)


def _of_body(
    document: Document, source: GltfSource | BareSource
) -> Iterator[tuple[Any, int, slice]]:
    for one in source.faces:
        primitive = primitives(document, one.mesh, "the document")[one.primitive]
        yield _what(document, one.mesh, primitive), one.first_vertex, one.rows


def _of_node(document: Document, number: int) -> Iterator[tuple[Any, int, slice]]:
    mesh = document.items("nodes")[number]["mesh"]
    for one in read_triangles(document, mesh, document.label("nodes", number))[2]:
        yield _what(document, mesh, one.primitive), one.first_vertex, one.rows


def _what(document: Document, mesh: int, primitive: dict[str, Any]) -> Any:
    """Return what colours a primitive: it, or a surface of the format that it was made of."""
    return primitive if document.surfaces is None else document.surfaces.meshes.get(mesh)
