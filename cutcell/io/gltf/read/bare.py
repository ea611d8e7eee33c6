"""The meshes of a glTF document that has no skin: one mesh, in the space of the scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....errors import MeshError
from ....rig import Part, Rig, Skeleton, TriangleMesh
from ..container import Document
from ..nodes import Nodes
from .parts import hidden_nodes, left_out_meshes, left_out_warnings, mesh_name, vanishes
from .primitives import StoredFaces, read_triangles


@dataclass(frozen=True, eq=False)
class StoredMesh:
    """A mesh of the document, where a node has it."""

    node: int
    mesh: int
    hidden: bool  # whether `KHR_node_visibility` hides it
    world: NDArray[np.float64]  # (4, 4): of the node
    first_vertices: list[int]  # in the rig, of each primitive that draws triangles, in order


@dataclass(frozen=True, eq=False)
class BareSource:
    """The glTF file without a skin that a rig came from, for saving."""

    document: Document
    mesh: TriangleMesh  # as it was read
    stored: list[StoredMesh]
    faces: tuple[StoredFaces, ...] = ()  # as they are now, if faces were repaired
    why_bare: str = ""  # why there are no joints, where the file lets expect some


def read_bare(document: Document, nodes: Nodes, name: str, why: str = "") -> Rig:
    """Return the scene's meshes as a rig without joints, in the scene's space and units.

    `why` says why it has no joints, if that may be a surprise.
    """
    in_scene = set(nodes.in_scene())
    mesh_nodes = [i for i, node in enumerate(nodes.raw) if "mesh" in node and i in in_scene]
    mesh_nodes = mesh_nodes or [i for i, node in enumerate(nodes.raw) if "mesh" in node]
    hidden = hidden_nodes(nodes)
    vertices, faces, parts, stored, total = [], [], [], [], 0
    stored_faces: list[StoredFaces] = []
    triangles = 0
    for i in mesh_nodes:
        mesh = nodes.raw[i]["mesh"]
        points, corners, drawn = read_triangles(document, mesh, document.label("nodes", i))
        if not len(corners):
            continue
        world = nodes.world[i]
        is_mirrored = bool(np.linalg.det(world[:3, :3]) < 0)
        if is_mirrored:
            corners = corners[:, ::-1]  # what was outside stays outside
        first = [total + one.first_vertex for one in drawn]
        stored.append(StoredMesh(i, mesh, i in hidden, world, first))
        for one, start in zip(drawn, first, strict=True):
            drawn_rows = slice(triangles + one.rows.start, triangles + one.rows.stop)
            stored_faces.append(StoredFaces(mesh, one.number, start, drawn_rows, is_mirrored))
        triangles += len(corners)
        document.allowance.take(points.nbytes + corners.nbytes, document.label("nodes", i))
        vertices.append(points @ world[:3, :3].T + world[:3, 3])
        faces.append(corners + total)
        rows = slice(total, total := total + len(points))
        hides = i in hidden or vanishes(nodes, i)
        parts.append(Part(mesh_name(document, nodes, i), rows, hides))
    if not faces:
        raise MeshError("its meshes have no triangles")
    whole = TriangleMesh(np.concatenate(vertices), np.concatenate(faces))  # type: ignore[arg-type]
    left_out = left_out_meshes(document, nodes, [one.node for one in stored], ())
    document.forget()
    return Rig(
        whole,
        Skeleton([], []),  # type: ignore[arg-type]
        name=name,
        parts=tuple(parts),
        left_out=left_out,
        warnings=(*document.warnings, *filter(None, [why]), *left_out_warnings(left_out, ())),
        source=BareSource(document, whole, stored, tuple(stored_faces), why),
    )
