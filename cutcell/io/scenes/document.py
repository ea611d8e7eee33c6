"""A scene of another format as a glTF document, so that one reader does for all.

A scene comes as arrays by name. Of k nodes, the root being the first: `node_names`,
`node_parents` (-1 for none), `node_transforms` (k, 10: translation, quaternion x y z w, scale),
`node_hidden`, `node_bones` (whether it is a joint by its own account). Of each mesh K:
`mesh_names[K]`, `mesh_nodes[K]`, `mesh_K_vertices` (n, 3), `mesh_K_faces` (m, 3),
`mesh_K_place` (4, 4) from its vertices to its node, and if it is skinned `mesh_K_joints` (j,
nodes), `mesh_K_inverse` (j, 4, 4) and its weights as `mesh_K_rows`, `_columns` and `_values`. Of
clips: `clip_names`; `tracks` (t, 4), ordered by clip: clip, node, what moves (see `PATHS`) and
number of keys; and `keys` (k, 5) of all tracks, seconds and a value, ascending in each track.
`scene_surfaces` says what may be there of materials.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

from ...errors import FileError, MeshError
from ..gltf.container import Document
from ..materials.scene_surfaces import scene_surfaces
from .joints import SceneSkin, scene_skins

CODES = {"f4": pygltflib.FLOAT, "u1": pygltflib.UNSIGNED_BYTE, "u2": pygltflib.UNSIGNED_SHORT,
         "u4": pygltflib.UNSIGNED_INT}  # fmt: skip
KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
PATHS = (("translation", 3), ("rotation", 4), ("scale", 3))
MAX_INFLUENCES = 64
"""Of one vertex, the strongest; sixteen sets of glTF hold them."""


def scene_document(scene: Mapping[str, NDArray], path: Path, generator: str) -> Document:
    """Return a scene as a document."""
    if not len(scene["mesh_names"]):
        raise FileError("has no mesh")
    bad = np.flatnonzero(~np.isfinite(scene["node_transforms"]).all(axis=1))
    if len(bad):
        name = scene["node_names"][bad[0]]
        raise FileError(f'node "{name}" has a place, turn or scale that is not a finite number')
    made = _Making(generator)
    made.add_nodes(scene)
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite then is told later
        skins = scene_skins(scene)
    for k in range(len(scene["mesh_names"])):
        made.add_mesh(scene, k, skins.get(k))
    made.add_clips(scene)
    document = made.finished(path)
    document.surfaces = scene_surfaces(scene, path, made.meshes)
    return document


class _Making:
    """A document under construction, with one buffer."""

    def __init__(self, generator: str) -> None:
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "materials": [{
                "name": "plain",
                "doubleSided": True,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [0.8, 0.8, 0.8, 1.0], "metallicFactor": 0.0,
                    "roughnessFactor": 0.8,
                },
            }],
            "nodes": [], "meshes": [], "accessors": [], "bufferViews": [],
        }  # fmt: skip
        self.data: list[bytes] = []
        self.size = 0
        self.meshes: dict[int, int] = {}
        """In the document, by the scene's numbers."""

    def add_nodes(self, scene: Mapping[str, NDArray]) -> None:
        for name, values in zip(scene["node_names"], scene["node_transforms"], strict=True):
            node: dict[str, Any] = {"name": str(name)} if name else {}
            parts = {"translation": values[:3], "rotation": values[3:7], "scale": values[7:]}
            for key, rest in (("translation", 0), ("rotation", [0, 0, 0, 1]), ("scale", 1)):
                if not np.array_equal(parts[key], np.broadcast_to(rest, parts[key].shape)):
                    node[key] = parts[key].tolist()
            self.json["nodes"].append(node)
        for i, parent in enumerate(scene["node_parents"].tolist()):
            if parent >= 0:
                self.json["nodes"][parent].setdefault("children", []).append(i)

    def add_mesh(self, scene: Mapping[str, NDArray], k: int, skin: SceneSkin | None) -> None:
        """Hang a mesh on a node of its own below its node: that one may have geometry already."""
        name = str(scene["mesh_names"][k])
        vertices, faces = scene[f"mesh_{k}_vertices"], scene[f"mesh_{k}_faces"]
        if not len(faces):
            return
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise MeshError(f'mesh "{name}": a face uses a vertex out of its {len(vertices)}')
        attributes = {"POSITION": self._floats(vertices, bounds=True)}
        node: dict[str, Any] = {"name": name, "mesh": len(self.json["meshes"])}
        if skin is not None:
            attributes |= self._weights(scene, k, skin, name, len(vertices))
            node["skin"] = self._skin(skin)
        elif not np.array_equal(scene[f"mesh_{k}_place"], np.eye(4)):
            node["matrix"] = scene[f"mesh_{k}_place"].T.ravel().tolist()
        indices = self._array(faces.reshape(-1, 1).astype("<u4"))
        primitive = {"attributes": attributes, "indices": indices, "material": 0}
        self.meshes[k] = len(self.json["meshes"])
        self.json["meshes"].append({"name": name, "primitives": [primitive]})
        self._hang(node, scene, int(scene["mesh_nodes"][k]))

    def _hang(self, node: dict[str, Any], scene: Mapping[str, NDArray], below: int) -> None:
        above, hidden = below, False
        while above >= 0:
            hidden |= bool(scene["node_hidden"][above])
            above = int(scene["node_parents"][above])
        if hidden:
            node["extensions"] = {"KHR_node_visibility": {"visible": False}}
            self.json["extensionsUsed"] = ["KHR_node_visibility"]
        self.json["nodes"].append(node)
        self.json["nodes"][below].setdefault("children", []).append(len(self.json["nodes"]) - 1)

    def _skin(self, skin: SceneSkin) -> int:
        binds = self._floats(skin.inverse.transpose(0, 2, 1).reshape(-1, 16))
        made = {"joints": skin.joints, "inverseBindMatrices": binds}
        self.json.setdefault("skins", []).append(made)
        return len(self.json["skins"]) - 1

    def _weights(
        self, scene: Mapping[str, NDArray], k: int, skin: SceneSkin, name: str, count: int
    ) -> dict[str, int]:
        rows, values = (scene.get(f"mesh_{k}_{key}", np.zeros(0)) for key in ("rows", "values"))
        if not len(rows):
            return {}
        if rows.min() < 0 or rows.max() >= count:
            raise MeshError(f'mesh "{name}": a weight is of a vertex out of its {count}')
        where, share = _packed(rows, scene[f"mesh_{k}_columns"], values, count)
        small = "<u1" if len(skin.joints) <= 256 else "<u2"
        found = {}
        for n in range(where.shape[1] // 4):
            four = slice(4 * n, 4 * n + 4)
            found[f"JOINTS_{n}"] = self._array(where[:, four].astype(small))
            found[f"WEIGHTS_{n}"] = self._floats(share[:, four])
        return found

    def add_clips(self, scene: Mapping[str, NDArray]) -> None:
        clips: list[dict[str, Any]] = [
            {"name": str(name), "channels": [], "samplers": []} for name in scene["clip_names"]
        ]
        end = 0
        for clip, node, path, count in scene["tracks"].tolist():
            keys = scene["keys"][end : (end := end + count)]
            name, width = PATHS[path]
            times = self._floats(keys[:, :1], bounds=True)
            sampler = {"input": times, "output": self._floats(keys[:, 1 : 1 + width])}
            target = {"node": node, "path": name}
            clips[clip]["channels"].append(
                {"sampler": len(clips[clip]["samplers"]), "target": target}
            )
            clips[clip]["samplers"].append(sampler)
        if clips:
            self.json["animations"] = clips

    def _floats(self, values: NDArray, bounds: bool = False) -> int:
        with np.errstate(over="ignore"):  # what is too large becomes infinite: the reader says so
            return self._array(values.astype("<f4"), bounds)

    def _array(self, values: NDArray, bounds: bool = False) -> int:
        content = np.ascontiguousarray(values).tobytes()
        padding = bytes(-self.size % 4)
        view = {"buffer": 0, "byteOffset": self.size + len(padding), "byteLength": len(content)}
        self.data += [padding, content]
        self.size += len(padding) + len(content)
        self.json["bufferViews"].append(view)
        accessor = {
            "bufferView": len(self.json["bufferViews"]) - 1,
            "componentType": CODES[values.dtype.str[1:]],
            "count": len(values),
            "type": KINDS[values.shape[1]],
        }
        if bounds:
            low, high = values.min(axis=0).tolist(), values.max(axis=0).tolist()
            accessor |= {"min": low, "max": high}
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def finished(self, path: Path) -> Document:
        self.json["buffers"] = [{"byteLength": self.size}]
        return Document(path, self.json, [b"".join(self.data)])


def _packed(
    rows: NDArray, columns: NDArray, values: NDArray, count: int
) -> tuple[NDArray, NDArray]:
    """Sort influences into slots of each vertex, the strongest first; a multiple of four slots."""
    order = np.lexsort((-values, rows))
    rows, columns, values = rows[order], columns[order], values[order]
    slot = np.arange(len(rows)) - np.searchsorted(rows, rows)
    most = min(int(slot.max()) + 1, MAX_INFLUENCES)
    shape = (count, -(-most // 4) * 4)
    where, share = np.zeros(shape, int), np.zeros(shape)
    fits = slot < most
    where[rows[fits], slot[fits]] = columns[fits]
    share[rows[fits], slot[fits]] = values[fits]
    return where, share
