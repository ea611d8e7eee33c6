"""A skeleton for the meshes of a glTF document that has none; whatever else it holds stays."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ....rig import Rig
from ..buffer import BufferWriter
from ..builder import GltfBuilder
from ..container import extensions
from ..influences import store_deform
from ..nodes import Nodes
from ..read.added_skins import add_skins
from ..read.primitives import draws_triangles
from ..read.read import BareSource, read_rig
from ..read.skins import Bind
from .fresh import add_clip, inverses, joint_nodes
from .write import rewritten

INSTANCES = "EXT_mesh_gpu_instancing"


def can_be_skinned(rig: Rig) -> bool:
    """Return whether the document that a rig's mesh came from can hold its skeleton and weights."""
    source = rig.source
    if not isinstance(source, BareSource):
        return False
    if not source.document.is_gltf:  # it has no more than a new document
        return False
    if not np.array_equal(rig.mesh.vertices, source.mesh.vertices):
        return False
    return np.array_equal(rig.mesh.faces, source.mesh.faces) and all(
        _is_plain(source, node) for node in source.placed
    )


def skinned(rig: Rig, path: Path) -> dict[Path, bytes]:
    """Return the files of a document that gets joints and skins, and is then saved as any other."""
    source: BareSource = rig.source
    stored, skeleton = source.document, rig.skeleton
    copied = {"json": json.loads(json.dumps(stored.json)), "buffers": list(stored.buffers)}
    document = replace(stored, warnings=[], **copied)
    first = len(document.json["nodes"])
    document.json["nodes"] += joint_nodes(skeleton, first)
    armature = first + len(skeleton.joints)
    _stand(document.json, armature)
    bind = Bind(nodes=list(range(first, armature)), inverse=list(inverses(skeleton)))
    add_skins(document, Nodes(document), bind, source.placed)
    store_deform(document.json, bind.skins.items(), skeleton.deform)
    if rig.clips:
        builder = GltfBuilder("")
        builder.json = document.json
        builder.buffer = BufferWriter(document.json, document.buffers)
        for clip in rig.clips:
            add_clip(builder, rig, clip, first)
        document.buffers = [builder.buffer.finish()]
    read = read_rig(document)
    joints = replace(read.skeleton, deform=skeleton.deform)
    return rewritten(replace(read, skeleton=joints, weights=rig.weights), path)


def _is_plain(source: BareSource, node: int) -> bool:
    """Return whether a node's mesh can be skinned: triangles only, and it mirrors nothing."""
    owner, meshes = source.document.json["nodes"][node], source.document.json["meshes"]
    of_triangles = all(draws_triangles(p) for p in meshes[owner["mesh"]]["primitives"])
    copied = INSTANCES in extensions(owner)
    return of_triangles and not copied and bool(np.linalg.det(source.placed[node][:3, :3]) > 0)


def _stand(document: dict[str, Any], node: int) -> None:
    """Add the last node to the scene."""
    scenes = document.setdefault("scenes", [{}])
    scene = scenes[document.setdefault("scene", 0)]
    if "nodes" not in scene:
        below = {child for one in document["nodes"] for child in one.get("children", [])}
        scene["nodes"] = [i for i in range(node) if i not in below]
    scene["nodes"].append(node)
