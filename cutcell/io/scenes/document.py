"""A scene of another format as a glTF document, so that one reader does for all.

A scene comes as arrays by name. Of k nodes, the root being the first: `node_names`,
`node_parents` (-1 for none), `node_transforms` (k, 10: translation, quaternion x y z w, scale),
`node_hidden`, `node_bones` (whether it is a joint by its own account). Of each mesh K:
`mesh_names[K]`, `mesh_nodes[K]`, `mesh_K_vertices` (n, 3), `mesh_K_faces` (m, 3),
`mesh_K_place` (4, 4) from its vertices to its node, and if it is skinned `mesh_K_joints` (j,
nodes), `mesh_K_inverse` (j, 4, 4) and its weights as `mesh_K_rows`, `_columns` and `_values`. Of
clips: `clip_names`; `tracks` (t, 4), ordered by clip: clip, node, what moves (see `PATHS`) and
number of keys; and `keys` (k, 5) of all tracks, seconds and a value, ascending in each track.
`mesh_K_dropped` names what of a mesh is not read. `scene_surfaces` says what may be there of
materials and corners.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError, MeshError
from ...isolated.run import WorkFailedError, run_isolated
from ...rig import Rig
from ...runtime.display import listed
from ..files import read_bytes
from ..gltf.builder import GltfBuilder
from ..gltf.container import Document
from ..gltf.influences import sorted_influences, store_influences
from ..gltf.read.read import read_rig
from ..gltf.read.skins import mended_warning
from ..materials.surfaces import scene_surfaces
from .joints import SceneSkin, scene_skins

PATHS = (("translation", 3), ("rotation", 4), ("scale", 3))
MAX_INFLUENCES = 64
"""Most influences of a vertex; sixteen sets of glTF hold them."""


def scene_document(
    scene: Mapping[str, NDArray], path: Path, generator: str, needs_mesh: bool = True
) -> tuple[Document, NDArray | None]:
    """Return a scene as a document, and the matrix (4, 4) of its first skinned mesh."""
    if needs_mesh and not len(scene["mesh_names"]):
        has_joints = scene["node_bones"].any()
        hint = ", but a skeleton: give it to the mesh of another file by --skeleton"
        notes = "".join(f". {note}" for note in scene["notes"])
        raise FileError(f"has no mesh{hint if has_joints else ''}{notes}")
    bad = np.flatnonzero(~np.isfinite(scene["node_transforms"]).all(axis=1))
    if len(bad):
        name = scene["node_names"][bad[0]]
        raise FileError(f'node "{name}" has a place, turn or scale that is not a finite number')
    made = _SceneBuilder(generator)
    made.add_nodes(scene)
    with np.errstate(over="ignore", invalid="ignore"):  # checked later
        skins, world = scene_skins(scene)
    for k in range(len(scene["mesh_names"])):
        made.add_scene_mesh(scene, k, skins.get(k))
    made.add_clips(scene)
    document = Document(path, made.json, [made.buffer.finish()])
    document.surfaces = scene_surfaces(scene, path, made.meshes)
    placed = dict.fromkeys(node for skin in skins.values() for node in skin.mended)
    if placed:
        names = [str(scene["node_names"][node]) for node in placed]
        document.warnings.append(mended_warning(names))
    return document, world


def _dropped(scene: Mapping[str, NDArray]) -> dict[str, list[str]]:
    """Return what a scene's file has and the scene has not, and the names of the meshes."""
    owners: dict[str, list[str]] = {}
    for k, name in enumerate(scene["mesh_names"].tolist()):
        for part in scene[f"mesh_{k}_dropped"].tolist():
            owners.setdefault(part, []).append(name)
    return owners


class _SceneBuilder(GltfBuilder):
    """A document under construction; `meshes` are its meshes by their numbers in the scene."""

    def __init__(self, generator: str) -> None:
        super().__init__(generator)
        self.meshes: dict[int, int] = {}

    def add_nodes(self, scene: Mapping[str, NDArray]) -> None:
        for name, values in zip(scene["node_names"], scene["node_transforms"], strict=True):
            node: dict[str, Any] = {"name": str(name)} if name else {}
            parts = {"translation": values[:3], "rotation": values[3:7], "scale": values[7:]}
            for key, rest in (("translation", 0), ("rotation", [0, 0, 0, 1]), ("scale", 1)):
                if not np.array_equal(parts[key], np.broadcast_to(rest, parts[key].shape)):
                    node[key] = parts[key].tolist()
            self.add_node(node)
        for i, parent in enumerate(scene["node_parents"].tolist()):
            if parent >= 0:
                self.json["nodes"][parent].setdefault("children", []).append(i)

    def add_scene_mesh(self, scene: Mapping[str, NDArray], k: int, skin: SceneSkin | None) -> None:
        """Add a mesh on a new node below its node, which may have geometry already."""
        name = str(scene["mesh_names"][k])
        vertices, faces = scene[f"mesh_{k}_vertices"], scene[f"mesh_{k}_faces"]
        if not len(faces):
            return
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise MeshError(f'mesh "{name}": a face uses a vertex out of its {len(vertices)}')
        attributes = {"POSITION": self.floats(vertices, bounds=True)}
        node: dict[str, Any] = {"name": name}
        if skin is not None:
            attributes |= self._weights(scene, k, skin, name, len(vertices))
            node["skin"] = self.add_skin(skin.joints, skin.inverse)
        elif not np.array_equal(scene[f"mesh_{k}_place"], np.eye(4)):
            node["matrix"] = scene[f"mesh_{k}_place"].T.ravel().tolist()
        node["mesh"] = self.meshes[k] = self.add_mesh(name, attributes, faces)
        above = int(scene["mesh_nodes"][k])
        while above >= 0 and not scene["node_hidden"][above]:
            above = int(scene["node_parents"][above])
        if above >= 0:
            node["extensions"] = {"KHR_node_visibility": {"visible": False}}
            self.json["extensionsUsed"] = ["KHR_node_visibility"]
        self.add_node(node, int(scene["mesh_nodes"][k]))

    def _weights(
        self, scene: Mapping[str, NDArray], k: int, skin: SceneSkin, name: str, count: int
    ) -> dict[str, int]:
        rows, values = (scene.get(f"mesh_{k}_{key}", np.zeros(0)) for key in ("rows", "values"))
        if not len(rows):
            return {}
        if rows.min() < 0 or rows.max() >= count:
            raise MeshError(f'mesh "{name}": a weight is of a vertex out of its {count}')
        columns = scene[f"mesh_{k}_columns"]
        influences = sorted_influences(rows, columns, values, count, MAX_INFLUENCES)
        with np.errstate(over="ignore"):  # readers refuse what becomes infinite
            return store_influences(self.buffer, influences, len(skin.joints), {})

    def add_clips(self, scene: Mapping[str, NDArray]) -> None:
        clips: list[dict[str, Any]] = [
            {"name": str(name), "channels": [], "samplers": []} for name in scene["clip_names"]
        ]
        end = 0
        for clip, node, path, count in scene["tracks"].tolist():
            keys = scene["keys"][end : (end := end + count)]
            name, width = PATHS[path]
            times = self.floats(keys[:, :1], target=None, bounds=True)
            self.add_track(clips[clip], node, name, times, keys[:, 1 : 1 + width])
        if clips:
            self.json["animations"] = clips


FBX_BINARY = b"Kaydara FBX Binary"
SECONDS, SECONDS_A_MEGABYTE = 60.0, 5.0
MIN_MEMORY, MEMORY_A_BYTE = 2**30, 100
"""Limits of the FBX reader. A byte of text takes some 20; arrays may be packed."""
USD_SECONDS, USD_MEMORY = 120.0, 2**32
READ = {
    "FBX": "meshes, skeleton, weights and clips",
    "USD": "meshes, skeletons, weights and motion",
}


def read_scene(path: Path, kind: str, accessories: bool = False) -> Rig:
    """Load a file whose kind is "FBX" or "USD"; see `cutcell.load`."""
    scene = scene_arrays(path, kind)
    document, world = scene_document(scene, path, f"cutcell, from {kind}")
    lost = (
        f"of {'an' if kind == 'FBX' else 'a'} {kind}, the {READ[kind]} are read, with normals, "
        "texture coordinates, and of its materials the base colours with their images; it is saved "
        "as a GLB without what else its materials have"
    )
    dropped = _dropped(scene)
    lost += "; not read: " * bool(dropped)
    lost += ", ".join(f"{part} ({listed(names)})" for part, names in dropped.items())
    document.warnings += [lost, *map(str, scene["notes"])]
    why_bare = (
        "it has no bones: only morph targets, which are not read, move its meshes. Give it a "
        "skeleton from another file, or fit one"
    )
    why_bare *= "morph targets" in dropped
    return read_rig(document, world, accessories, why_bare)


def scene_arrays(path: Path, kind: str) -> Mapping[str, NDArray]:
    """Return the arrays of an FBX or USD file; see `document`."""
    data = read_bytes(path)
    job = {"path": np.array(str(path.resolve()))}
    seconds, memory, extra = USD_SECONDS, USD_MEMORY, "cutcell[usd]"
    if kind == "FBX":
        if not data.startswith(FBX_BINARY) and b"FBX" not in data[:4096]:
            raise FileError(
                "is not an FBX file: neither binary nor text in its first lines says so"
            )
        job, extra = {"data": np.frombuffer(data, np.uint8)}, "cutcell"
        seconds = SECONDS + SECONDS_A_MEGABYTE * len(data) / 2**20
        memory = MIN_MEMORY + MEMORY_A_BYTE * len(data)
    task, who = f"cutcell.isolated.{kind.lower()}:read", f"the {kind} reader"
    try:
        return run_isolated(task, job, seconds, who, memory, extra)
    except WorkFailedError as e:
        raise FileError(f"cannot be read as {kind}: {e}") from None
