"""A skin for the meshes of a glTF document that has none; whatever else it holds stays.

The node of a skinned mesh does not move it, only its joints do. So its inverse bind matrices start
from the world matrix of its old node, and the mesh moves to a new node.
"""

from __future__ import annotations

import json
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import WeightsError
from ....rig import Rig
from ...materials.gltf_images import carry_images
from ..buffer import BufferWriter
from ..influences import pack_influences, store_deform, store_influences, take_influences
from ..read.bare import BareSource, StoredMesh
from ..read.primitives import draws_triangles
from .fresh import inverses, joint_nodes
from .write import packed

INSTANCES = "EXT_mesh_gpu_instancing"


def can_be_skinned(rig: Rig) -> bool:
    """Return whether the document that a rig's mesh came from can hold its skeleton and weights."""
    source = rig.source
    if not isinstance(source, BareSource) or rig.clips:
        return False
    if source.document.path.suffix.lower() not in (".glb", ".gltf"):
        return False  # what was made of another format has no more than a new document
    same = all(
        np.array_equal(current, original)
        for current, original in (
            (rig.mesh.vertices, source.mesh.vertices),
            (rig.mesh.faces, source.mesh.faces),
        )
    )
    return same and all(_is_plain(source, one) for one in source.stored)


def skinned(rig: Rig, path: Path) -> dict[Path, bytes]:
    """Return the files to write so that a document holds a rig's skeleton and weights."""
    if rig.weights is None:
        raise WeightsError("the rig has no weights to save; bind it first")
    source: BareSource = rig.source
    document = json.loads(json.dumps(source.document.json))
    edit = _Edit(document, BufferWriter(document, source.document.buffers), rig)
    for one in source.stored:
        edit.skin(one)
    carried = carry_images(edit.buffer, source.document, path)
    return {**carried, **packed(edit.buffer, source.document, path, carried)}


def _is_plain(source: BareSource, one: StoredMesh) -> bool:
    """Return whether a mesh can be skinned: triangles only, and its node mirrors nothing."""
    loaded = source.document.json
    of_triangles = all(draws_triangles(p) for p in loaded["meshes"][one.mesh]["primitives"])
    extensions = loaded["nodes"][one.node].get("extensions")
    copied = isinstance(extensions, dict) and INSTANCES in extensions
    return of_triangles and not copied and bool(np.linalg.det(one.world[:3, :3]) > 0)


class _Edit:
    """A document that gets a skeleton."""

    def __init__(self, document: dict[str, Any], buffer: BufferWriter, rig: Rig) -> None:
        self.document, self.buffer, self.rig = document, buffer, rig
        first = len(document["nodes"])
        self._joints = list(range(first, first + len(rig.skeleton.joints)))
        document["nodes"] += joint_nodes(rig.skeleton, first)
        self._stand(len(document["nodes"]) - 1)
        self._influences: dict[int, dict[str, int]] = {}
        self._skins: dict[bytes, int] = {}

    def skin(self, one: StoredMesh) -> None:
        """Give a mesh its weights, and a node on which only its skin moves it."""
        meshes, nodes = self.document["meshes"], self.document["nodes"]
        place, number = nodes[one.node], one.mesh
        if any(n.get("mesh") == number for i, n in enumerate(nodes) if i != one.node):
            meshes.append(deepcopy(meshes[number]))  # another node shows it, too
            number = len(meshes) - 1
        primitives = meshes[number]["primitives"]
        for primitive, first in zip(primitives, one.first_vertices, strict=True):
            attributes = primitive["attributes"]
            take_influences(attributes)
            count = self.document["accessors"][attributes["POSITION"]]["count"]
            attributes.update(self._stored(first, count))
        new = {key: place.pop(key) for key in ("mesh", "weights") if key in place}
        new |= {"mesh": number, "skin": self._skin(one.world)}
        if one.hidden:
            new["extensions"] = {"KHR_node_visibility": {"visible": False}}
        nodes.append({"name": place.get("name", meshes[number].get("name", "mesh")), **new})
        self._stand(len(nodes) - 1)
        for animation in self.document.get("animations", []):
            for channel in animation["channels"]:
                target = channel["target"]
                if (target.get("node"), target.get("path")) == (one.node, "weights"):
                    target["node"] = len(nodes) - 1

    def _stored(self, first: int, count: int) -> dict[str, int]:
        """Store the weights of some vertices, once."""
        if first not in self._influences:
            assert self.rig.weights is not None
            packed = pack_influences(self.rig.weights[first : first + count])
            self._influences[first] = store_influences(self.buffer, packed, len(self._joints))
        return self._influences[first]

    def _skin(self, world: NDArray[np.float64]) -> int:
        """Return the skin of meshes whose nodes have a world matrix."""
        key = world.tobytes()
        if key not in self._skins:
            binds = (inverses(self.rig.skeleton) @ world).transpose(0, 2, 1).reshape(-1, 16)
            stored = self.buffer.store(binds.astype("<f4"), target=None)
            skins = self.document.setdefault("skins", [])
            skins.append({"joints": self._joints, "inverseBindMatrices": stored})
            number = self._skins[key] = len(skins) - 1
            deform = self.rig.skeleton.deform
            store_deform(self.document, [(number, range(len(deform)))], deform)
        return self._skins[key]

    def _stand(self, node: int) -> None:
        """Add a node to the scene."""
        scenes = self.document.setdefault("scenes", [{}])
        scene = scenes[self.document.setdefault("scene", 0)]
        if "nodes" not in scene:
            nodes = self.document["nodes"]
            below = {child for one in nodes for child in one.get("children", [])}
            scene["nodes"] = [i for i in range(node) if i not in below]
        scene["nodes"].append(node)
