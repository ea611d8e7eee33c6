"""New glTF documents: nodes, meshes, skins and animations with one buffer."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .buffer import BufferWriter
from .constants import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER

# The default material of glTF is metal, which looks black without surroundings.
PLAIN_MATERIAL = {
    "name": "plain",
    "doubleSided": True,
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.8, 0.8, 0.8, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.8,
    },
}


class GltfBuilder:
    """A document under construction, with one plain material."""

    def __init__(self, generator: str) -> None:
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "materials": [deepcopy(PLAIN_MATERIAL)],
            "nodes": [],
            "meshes": [],
        }
        self.buffer = BufferWriter(self.json)

    def add(self, kind: str, item: dict[str, Any]) -> int:
        """Append an object to a top-level list and return its number."""
        self.json.setdefault(kind, []).append(item)
        return len(self.json[kind]) - 1

    def add_node(self, node: dict[str, Any], parent: int | None = None) -> int:
        """Append a node, perhaps below another one, and return its number."""
        number = self.add("nodes", node)
        if parent is not None:
            self.json["nodes"][parent].setdefault("children", []).append(number)
        return number

    def add_mesh(self, name: str, attributes: dict[str, int], faces: NDArray) -> int:
        """Append a mesh with one primitive. Shapes: faces (m, 3)."""
        count = self.buffer.accessors[attributes["POSITION"]]["count"]
        kind = "<u2" if count <= np.iinfo(np.uint16).max else "<u4"
        indices = self.buffer.store(faces.reshape(-1, 1).astype(kind), target=ELEMENT_ARRAY_BUFFER)
        primitive = {"attributes": attributes, "indices": indices, "material": 0}
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def add_skin(self, joints: list[int], inverse: NDArray, **fields: Any) -> int:
        """Append a skin. Shapes: inverse (j, 4, 4)."""
        binds = self.floats(inverse.transpose(0, 2, 1).reshape(-1, 16), target=None)
        return self.add("skins", {"joints": joints, "inverseBindMatrices": binds, **fields})

    def add_track(
        self, animation: dict[str, Any], node: int, path: str, times: int, values: NDArray
    ) -> None:
        """Append the motion of a node (k, 3 or 4) to an animation; `times` is an accessor."""
        sampler = {"input": times, "output": self.floats(values, target=None)}
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]), "target": target})
        animation["samplers"].append(sampler)

    def floats(
        self, values: NDArray, target: int | None = ARRAY_BUFFER, bounds: bool = False
    ) -> int:
        """Store an array as 32-bit floats and return its accessor."""
        with np.errstate(over="ignore"):  # readers refuse what becomes infinite
            return self.buffer.store(values.astype("<f4"), None, target, bounds)
