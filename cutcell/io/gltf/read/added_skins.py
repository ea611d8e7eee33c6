"""Skins for meshes of a document that have none: of bones that are plain nodes, of accessories.

The document is edited before its meshes are read, so that it is read and saved as any other. Nodes
keep their meshes and their places. The place of a skinned mesh's node has no effect, so inverse
bind matrices contain it.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from copy import deepcopy

import numpy as np
from numpy.typing import NDArray

from ....errors import MeshError
from ....rig import Attachment, TriangleMesh
from ....rig.transforms import moved
from ....runtime.display import listed
from ..container import Document
from ..influences import take_influences
from ..nodes import Nodes, target_of
from .bones import Bones, find_bones, human_bones
from .parts import draws_mesh, hidden_nodes, mesh_name, vanishes
from .primitives import primitives, read_triangles
from .skins import Bind


def bind_to_bones(document: Document, nodes: Nodes) -> tuple[Bind | None, str]:
    """Give skins to the meshes of a document, in the scene's space, or say why it has no bones.

    Meshes below a bone are accessories, unless all are.
    """
    meshes = [
        i
        for i in nodes.in_scene()
        if "mesh" in nodes.raw[i] and draws_mesh(document, nodes, i) and has_volume(nodes.world[i])
    ]
    bones = find_bones(document, nodes, _bounds(document, nodes, meshes))
    bones.joints = [i for i in bones.joints if has_volume(nodes.world[i])]
    if not bones.joints or not meshes:
        return None, bones.why_none or _why_none(document, nodes, meshes)
    nearest = nodes.nearest(set(bones.joints))
    free = [i for i in meshes if nearest[i] < 0 or nearest[i] in bones.tops]
    if not free:
        document.warnings.append(
            f"each of its {len(meshes)} meshes hangs on a bone and moves rigidly with it; all of "
            "them are bound"
        )
    _name(document, nodes, bones)
    bind = Bind(nodes=bones.joints, inverse=list(np.linalg.inv(nodes.world[bones.joints])))
    add_skins(document, nodes, bind, {i: nodes.world[i] for i in free or meshes})
    return bind, ""


def has_volume(matrix: NDArray[np.float64]) -> bool:
    """Return whether a matrix (4, 4) scales nothing to zero along any axis."""
    return bool(np.linalg.matrix_rank(matrix[:3, :3]) == 3)


def add_skins(document: Document, nodes: Nodes, bind: Bind, to_rig: dict[int, NDArray]) -> None:
    """Give a skin of all joints to nodes with meshes; their matrices lead to the rig's space."""
    skins: dict[bytes, int] = {}
    used = {node["mesh"] for i, node in enumerate(nodes.raw) if "mesh" in node and i not in to_rig}
    for i, matrix in to_rig.items():
        key = matrix.tobytes()
        if key not in skins:
            skin = skins[key] = _add_skin(document, bind.nodes, np.array(bind.inverse) @ matrix)
            bind.skins[skin] = list(range(len(bind.nodes)))
            bind.to_rig[skin] = matrix
        node = nodes.raw[i]
        if node["mesh"] in used:  # other nodes show it in another way
            copied = deepcopy(document.items("meshes")[node["mesh"]])
            node["mesh"] = _append(document, "meshes", copied)
        used.add(node["mesh"])
        for primitive in primitives(document, node["mesh"], document.label("nodes", i)):
            take_influences(primitive.attributes)  # of another skin
        node["skin"] = skins[key]


def _add_skin(document: Document, joints: list[int], inverse: NDArray[np.float64]) -> int:
    """Append a skin and its inverse bind matrices, shape (j, 4, 4), in a buffer of their own."""
    data = np.ascontiguousarray(inverse.transpose(0, 2, 1), "<f4").tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    buffer = _append(document, "buffers", {"byteLength": len(data), "uri": uri})
    document.buffers += [b""] * (buffer - len(document.buffers)) + [data]
    view = _append(document, "bufferViews", {"buffer": buffer, "byteLength": len(data)})
    values = {"bufferView": view, "componentType": 5126, "count": len(joints), "type": "MAT4"}
    accessor = _append(document, "accessors", values)
    return _append(document, "skins", {"joints": list(joints), "inverseBindMatrices": accessor})


def _append(document: Document, kind: str, item: dict) -> int:
    """Append an object to a top-level list and return its number."""
    document.json.setdefault(kind, []).append(item)
    return len(document.items(kind)) - 1


def _name(document: Document, nodes: Nodes, bones: Bones) -> None:
    """Give bones without a name the one that VRM's humanoid has for them."""
    names = human_bones(document)
    for i in bones.joints:
        if i in names and not nodes.raw[i].get("name"):
            nodes.raw[i]["name"] = names[i]


def _bounds(document: Document, nodes: Nodes, meshes: list[int]) -> tuple[NDArray, NDArray] | None:
    """Return the lowest and highest coordinates of meshes in the scene."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for i in meshes:
        vertices = read_triangles(document, nodes.raw[i]["mesh"], document.label("nodes", i))[0]
        if len(vertices):
            placed = moved(vertices, nodes.world[i])
            low, high = np.minimum(low, placed.min(axis=0)), np.maximum(high, placed.max(axis=0))
    return (low, high) if (low <= high).all() else None


def _why_none(document: Document, nodes: Nodes, meshes: list[int]) -> str:
    """Return why a document that moves has no joints; an empty text if nothing moves in it."""
    turned: set[int] = set()
    morphed: set[int] = set()
    for clip in document.items("animations"):
        channels = clip.get("channels")
        for channel in channels if isinstance(channels, list) else ():
            if isinstance(channel, dict) and isinstance(channel.get("target"), dict):
                node, path = target_of(channel)
                (morphed if path == "weights" else turned).add(node if type(node) is int else -1)
    rigid = [i for i in meshes if set(nodes.with_ancestors([i])) & turned]
    if rigid:
        names = listed([mesh_name(document, nodes, i) for i in rigid])
        return (
            f"it has no skin and no bones: the nodes of its meshes move them rigidly ({names}). "
            "Give it a skeleton from another file, or fit one"
        )
    if set(meshes) & morphed:
        names = listed([mesh_name(document, nodes, i) for i in meshes if i in morphed])
        return (
            f"it has no skin and no bones: only morph targets move its mesh ({names}). Give it a "
            "skeleton from another file, or fit one"
        )
    return ""


def _hanging(document: Document, nodes: Nodes, bind: Bind) -> Iterator[tuple[int, int, NDArray]]:
    """Yield nodes with a mesh without a skin below a joint, the joint, the matrix to the rig."""
    place = {node: j for j, node in enumerate(bind.nodes)}
    nearest = nodes.nearest(place)
    # From the mesh up to the joint by the local transforms: a joint that is scaled to nothing at
    # rest (a hidden weapon) could not be inverted.
    local = nodes.relative_to(bind.nodes)
    for i, node in enumerate(nodes.raw):
        if "mesh" not in node or "skin" in node or nearest[i] < 0:
            continue
        joint = place[nearest[i]]
        drawn = read_triangles(document, node["mesh"], document.label("nodes", i))[2]
        if drawn and local[i, :3, :3].any():
            yield i, joint, np.linalg.inv(bind.inverse[joint]) @ local[i]


def bind_accessories(document: Document, nodes: Nodes, bind: Bind) -> dict[int, int]:
    """Give skins to the meshes of the scene without one; return the joint of each that has one."""
    hanging = {i: (joint, to_rig) for i, joint, to_rig in _hanging(document, nodes, bind)}
    to_rig = {i: matrix for i, (_, matrix) in hanging.items()}
    if has_volume(bind.world):
        from_scene = np.linalg.inv(bind.world)
        bare = {i for i in nodes.in_scene() if nodes.raw[i].keys() & {"mesh", "skin"} == {"mesh"}}
        to_rig |= {i: from_scene @ nodes.world[i] for i in bare - hanging.keys()}
    to_rig = {
        i: matrix
        for i, matrix in sorted(to_rig.items())
        if draws_mesh(document, nodes, i) and not vanishes(nodes, i) and has_volume(matrix)
    }
    add_skins(document, nodes, bind, to_rig)
    return {nodes.raw[i]["mesh"]: hanging[i][0] for i in to_rig if i in hanging}


def read_attachments(document: Document, nodes: Nodes, bind: Bind) -> dict[int, Attachment]:
    """Return the attachment of each node that has one."""
    hidden = hidden_nodes(nodes)
    attachments: dict[int, Attachment] = {}
    for i, joint, to_rig in _hanging(document, nodes, bind):
        label = document.label("nodes", i)
        vertices, corners, _ = read_triangles(document, nodes.raw[i]["mesh"], label)
        document.allowance.take(vertices.nbytes + corners.nbytes, label)
        faces = corners[:, ::-1] if np.linalg.det(to_rig[:3, :3]) < 0 else corners
        name = nodes.raw[i].get("name") or f"attachment {len(attachments)}"
        try:
            mesh = TriangleMesh(moved(vertices, to_rig), faces)  # type: ignore[arg-type]
        except MeshError as e:
            raise MeshError(f"{label}: {e}") from None
        attachments[i] = Attachment(str(name), mesh, joint, i in hidden or vanishes(nodes, i))
    return attachments
