"""The meshes of a glTF document that has no skin: one mesh, where they stand in the scene."""

from __future__ import annotations

import numpy as np

from ..errors import MeshError
from ..rig import Part, Rig, Skeleton, TriangleMesh
from .gltf_container import Document
from .gltf_nodes import Nodes
from .gltf_parts import hidden_nodes, left_out_meshes, mesh_name, vanishes
from .gltf_primitives import read_triangles


def read_bare(document: Document, nodes: Nodes, name: str) -> Rig:
    """Return the scene's meshes as a rig without joints, in the scene's space and units."""
    here = set(nodes.in_scene())
    shown = [i for i, node in enumerate(nodes.raw) if "mesh" in node and i in here]
    shown = shown or [i for i, node in enumerate(nodes.raw) if "mesh" in node]
    hidden = hidden_nodes(nodes)
    vertices, faces, parts, kept, total = [], [], [], [], 0
    for i in shown:
        points, corners, _ = read_triangles(
            document, nodes.raw[i]["mesh"], document.label("nodes", i)
        )
        if not len(corners):
            continue
        world = nodes.world[i]
        if np.linalg.det(world[:3, :3]) < 0:
            corners = corners[:, ::-1]  # mirrored: what was outside stays outside
        kept.append(i)
        document.allowance.take(points.nbytes + corners.nbytes, document.label("nodes", i))
        vertices.append(points @ world[:3, :3].T + world[:3, 3])
        faces.append(corners + total)
        rows = slice(total, total := total + len(points))
        hides = i in hidden or vanishes(nodes, i)
        parts.append(Part(mesh_name(document, nodes, i), rows, hides))
    if not faces:
        raise MeshError("its meshes have no triangles")
    return Rig(
        TriangleMesh(np.concatenate(vertices), np.concatenate(faces)),  # type: ignore[arg-type]
        Skeleton([], []),  # type: ignore[arg-type]
        name=name,
        parts=tuple(parts),
        left_out=left_out_meshes(document, nodes, kept, ()),
    )
