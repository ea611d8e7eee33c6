"""From a glTF document to a Rig."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CutcellError, FileError, MeshError
from ..rig import Attachment, Part, Rig, TriangleMesh
from .deforming import with_deform
from .gltf_bare import read_bare
from .gltf_clips import read_clips
from .gltf_container import Document, read_document
from .gltf_draco import decompress_draco
from .gltf_meshopt import decompress_meshopt
from .gltf_nodes import Nodes
from .gltf_parts import hidden_nodes, left_out_meshes, mesh_name, vanishes
from .gltf_primitives import (
    attributes,
    draws_triangles,
    primitives,
    read_faces,
    read_positions,
    read_triangles,
    read_weights,
)
from .gltf_skins import Bind, read_bind, read_skeleton


@dataclass(eq=False)
class StoredPart:
    """Vertices that are stored together: one vertex buffer bound to one skin."""

    label: str
    primitives: list[tuple[int, int]]
    """(mesh, primitive) that draw from it."""
    skin: int
    rows: slice
    """Its vertices in the rig."""
    joints: Sequence[int]
    """Joint of the rig for each joint of the skin."""


@dataclass(eq=False)
class GltfSource:
    """What a rig remembers of its glTF file, for saving."""

    document: Document
    parts: list[StoredPart]
    joints: tuple[str, ...]


def read_gltf(path: Path) -> Rig:
    """Load a GLB or glTF file; see `cutcell.load`."""
    try:
        document = read_document(path)
        decompress_meshopt(document)
        decompress_draco(document)
        return read_rig(document, path)
    except CutcellError:
        raise
    except (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError) as e:
        # Fields that no check above looked at, in a document that is not what it says.
        raise FileError(f"its glTF document is malformed ({type(e).__name__}: {e})") from e


def read_rig(document: Document, path: Path, world: NDArray | None = None) -> Rig:
    """Return what a document with plain accessors holds; `world` is of `read_bind`."""
    nodes = Nodes(document)
    skinned = _skinned_nodes(nodes)
    if not skinned:
        return read_bare(document, nodes, path.stem)
    for i in skinned:
        document.item("skins", nodes.raw[i]["skin"], document.label("nodes", i))
    skins = list(dict.fromkeys(nodes.raw[i]["skin"] for i in skinned))
    bind = read_bind(document, nodes, skins, world)
    parts, vertices, faces, stored, named = _read_parts(document, nodes, skinned, bind)
    if not faces or not sum(len(f) for f in faces):
        raise MeshError("its skinned meshes have no triangles")
    mesh = TriangleMesh(np.concatenate(vertices), np.concatenate(faces))  # type: ignore[arg-type]
    weights = _dense(parts, stored, len(mesh.vertices), len(bind.nodes))
    skeleton, told = with_deform(mesh, read_skeleton(nodes, bind), weights)
    attached = _read_attachments(document, nodes, bind)
    return Rig(
        mesh,
        skeleton,
        weights,
        clips=read_clips(document, nodes, bind.nodes, np.array(bind.inverse), bind.world),
        attachments=tuple(attached.values()),
        name=path.stem,
        world=bind.world,
        allowed=_allowed(parts, len(mesh.vertices), len(bind.nodes)),
        parts=named,
        left_out=left_out_meshes(document, nodes, skinned, attached),
        warnings=(*document.warnings, *told),
        source=GltfSource(document, parts, skeleton.names),
    )


def _skinned_nodes(nodes: Nodes) -> list[int]:
    """Return the nodes with a skinned mesh, those of the default scene if it has any."""
    skinned = [i for i, n in enumerate(nodes.raw) if "skin" in n and "mesh" in n]
    if not skinned and not any("mesh" in n for n in nodes.raw):
        raise FileError("has no mesh")
    return sorted(set(skinned) & set(nodes.in_scene())) or skinned


def _read_parts(
    document: Document, nodes: Nodes, skinned: list[int], bind: Bind
) -> tuple[list[StoredPart], list[NDArray], list[NDArray], list[NDArray | None], tuple[Part, ...]]:
    """Read every vertex buffer once, however many primitives draw from it.

    A mesh that stands in the scene twice, with two skins, is read for the first: both
    draw with the same stored weights.
    """
    parts: dict[Any, StoredPart] = {}
    vertices: list[NDArray] = []
    faces: list[NDArray] = []
    stored: list[NDArray | None] = []
    named: list[Part] = []
    hidden = hidden_nodes(nodes)
    seen: set[tuple[int, int]] = set()
    total = 0
    for i in skinned:
        mesh, skin, first = nodes.raw[i]["mesh"], nodes.raw[i]["skin"], total
        for k, primitive in enumerate(primitives(document, mesh, document.label("nodes", i))):
            if (mesh, k) in seen or not draws_triangles(primitive):
                continue
            seen.add((mesh, k))
            label = f"{document.label('meshes', mesh)}, primitive {k}"
            positions = read_positions(document, primitive, label)
            corners = read_faces(document, primitive, len(positions), label)
            key = (skin, _vertex_key(primitive, label))
            if key not in parts:
                rows = slice(total, total := total + len(positions))
                parts[key] = StoredPart(label, [], skin, rows, bind.skins[skin])
                vertices.append(_moved(positions, bind.to_rig[skin]))
                joints = len(bind.skins[skin])
                stored.append(read_weights(document, primitive, len(positions), joints, label))
            parts[key].primitives.append((mesh, k))
            if np.linalg.det(bind.to_rig[skin][:3, :3]) < 0:
                corners = corners[:, ::-1]  # mirrored: what was outside stays outside
            faces.append(corners + parts[key].rows.start)
        if total > first:
            rows = slice(first, total)
            named.append(Part(mesh_name(document, nodes, i), rows, i in hidden))
    return list(parts.values()), vertices, faces, stored, tuple(named)


def _vertex_key(primitive: dict[str, Any], label: str) -> tuple:
    found = attributes(primitive, label)
    names = ("POSITION", "JOINTS_", "WEIGHTS_")
    return tuple(sorted((k, v) for k, v in found.items() if k.startswith(names)))


def _moved(points: NDArray, matrix: NDArray) -> NDArray:
    if np.array_equal(matrix, np.eye(4)):
        return points
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def _dense(parts: list[StoredPart], stored: list, vertices: int, joints: int) -> NDArray | None:
    if all(s is None for s in stored):
        return None
    weights = np.zeros((vertices, joints))
    for part, values in zip(parts, stored, strict=True):
        if values is not None:
            weights[part.rows, part.joints] = values
    return weights


def _allowed(parts: list[StoredPart], vertices: int, joints: int) -> NDArray | None:
    if all(len(part.joints) == joints for part in parts):
        return None
    allowed = np.zeros((vertices, joints), bool)
    for part in parts:
        allowed[part.rows, part.joints] = True
    return allowed


def _read_attachments(document: Document, nodes: Nodes, bind: Bind) -> dict[int, Attachment]:
    """Return the attachment of each node that has one."""
    place = {node: j for j, node in enumerate(bind.nodes)}
    hidden = hidden_nodes(nodes)
    found: dict[int, Attachment] = {}
    for i, node in enumerate(nodes.raw):
        if "mesh" not in node or "skin" in node:
            continue
        chain = [i, *nodes.ancestors(i)]
        above = next((k for k, a in enumerate(chain) if a in place), None)
        if above is None:
            continue
        # From the mesh up to the joint by the local transforms: a joint that is scaled to
        # nothing at rest (a hidden weapon) could not be inverted.
        local = np.eye(4)
        for a in chain[:above]:
            local = nodes.local[a] @ local
        joint = place[chain[above]]
        vertices, faces, drawn = read_triangles(document, node["mesh"], document.label("nodes", i))
        if not drawn or not local[:3, :3].any():
            continue
        to_rig = np.linalg.inv(bind.inverse[joint]) @ local
        if np.linalg.det(to_rig[:3, :3]) < 0:
            faces = faces[:, ::-1]
        name = node.get("name") or f"attachment {len(found)}"
        try:
            mesh = TriangleMesh(_moved(vertices, to_rig), faces)  # type: ignore[arg-type]
        except MeshError as e:
            raise MeshError(f"{document.label('nodes', i)}: {e}") from None
        found[i] = Attachment(str(name), mesh, joint, i in hidden or vanishes(nodes, i))
    return found
