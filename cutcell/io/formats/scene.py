"""FBX 6.1 to 7.7, and USD with UsdSkel, as glTF documents, so that one reader does for all.

A subprocess reads the scene, which comes as arrays by name. Of k nodes, the root being the first:
`node_names`, `node_parents` (-1 for none), `node_transforms` (k, 10: translation, quaternion x y z
w, scale), `node_hidden`, `node_bones` (whether it is a joint by its own account). Of each mesh K:
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
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError, MeshError
from ...isolated.run import WorkFailedError, run_isolated
from ...rig import Rig
from ...rig.transforms import composed
from ...runtime.display import listed
from ..files import read_bytes
from ..gltf.buffer import GltfBuilder
from ..gltf.container import Document
from ..gltf.influences import influence_attributes, sorted_influences
from ..gltf.nodes import compose
from ..gltf.read.read import read_rig
from ..materials.surfaces import scene_surfaces
from ..skeletons import SkeletonFile, of_document

SUFFIXES = {
    ".fbx": rb"Kaydara FBX|;\s*FBX",
    ".usd": rb"PXR-USDC|#usda",
    ".usda": rb"#usda",
    ".usdc": rb"PXR-USDC",
    ".usdz": rb"PK",
}
NOTE = "USD with cutcell[usd]"
WEIGHTS = ("columns", "values")
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
            attributes |= self._weights(scene, k, len(skin[0]), name, len(vertices))
            node["skin"] = self.add_skin(*skin)
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
        self, scene: Mapping[str, NDArray], k: int, joints: int, name: str, count: int
    ) -> dict[str, int]:
        rows, values = (scene.get(f"mesh_{k}_{key}", np.zeros(0)) for key in ("rows", "values"))
        if not len(rows):
            return {}
        if rows.min() < 0 or rows.max() >= count:
            raise MeshError(f'mesh "{name}": a weight is of a vertex out of its {count}')
        columns = scene[f"mesh_{k}_columns"]
        influences = sorted_influences(rows, columns, values, count, MAX_INFLUENCES)
        with np.errstate(over="ignore"):  # readers refuse what becomes infinite
            attributes = influence_attributes(influences, joints)
        return {name: self.buffer.store(one) for name, one in attributes.items()}

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


def read(path: Path, accessories: bool = False, bare: bool = False) -> Rig:
    """Load an FBX or USD file; see `cutcell.load`."""
    kind, scene = _kind(path), scene_arrays(path)
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


def read_skeleton(path: Path) -> SkeletonFile:
    """Read the bones and the clips of a scene, which need not have a mesh."""
    scene = scene_arrays(path)
    document, place = scene_document(scene, path, "cutcell", needs_mesh=False)
    return of_document(document, np.flatnonzero(scene["node_bones"]).tolist(), place)


def _kind(path: Path) -> str:
    return "FBX" if path.suffix.lower() == ".fbx" else "USD"


def scene_arrays(path: Path) -> Mapping[str, NDArray]:
    """Return the arrays of an FBX or USD file, as above."""
    data, kind = read_bytes(path), _kind(path)
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


SceneSkin: TypeAlias = tuple[list[int], NDArray[np.float64]]
"""The joints of a mesh, as nodes, and their inverse bind matrices, shape (j, 4, 4)."""


def scene_skins(scene: Mapping[str, NDArray]) -> tuple[dict[int, SceneSkin], NDArray | None]:
    """Return the skin of each mesh that has one, and the matrix of the first such mesh.

    A skin names the joints that hold a vertex. The other bones of the same tree (fingertips,
    roots, helpers) join the first mesh that is bound to it, where they are at rest relative to
    the nearest bone above that it knows. In a scene without any weights each mesh that is
    below no bone, or each if all are below one, is bound to all bones in their current position.
    """
    parents, transforms = scene["node_parents"].tolist(), scene["node_transforms"]
    local = compose(transforms[:, :3], transforms[:, 3:7], transforms[:, 7:])
    world = composed(local, scene["node_parents"])
    bones = np.flatnonzero(scene["node_bones"]).tolist()
    meshes = range(len(scene["mesh_names"]))
    skins: dict[int, SceneSkin] = {
        k: (scene[f"mesh_{k}_joints"].tolist(), scene[f"mesh_{k}_inverse"])
        for k in meshes
        if len(scene.get(f"mesh_{k}_joints", ()))
    }
    skins = skins or _unbound(scene, parents, world, bones)
    if not skins:
        return {}, None
    first = min(skins)  # its joints may be posed
    stands = world[int(scene["mesh_nodes"][first])] @ scene[f"mesh_{first}_place"]
    assigned: set[int] = {joint for joints, _ in skins.values() for joint in joints}
    for k, (joints, inverse) in skins.items():
        trees = {_above(joint, parents)[-1] for joint in joints}
        more = [b for b in bones if b not in assigned and _above(b, parents)[-1] in trees]
        columns, values = (scene.get(f"mesh_{k}_{key}", np.zeros(0)) for key in WEIGHTS)
        # Relative to joints that hold a vertex: the matrices of others may contradict their nodes.
        held = [j for j in np.unique(columns[values > 0]).tolist() if 0 <= j < len(joints)]
        number = {joints[j]: j for j in held or range(len(joints))}
        for bone in filter(lambda bone: _inverse(world[bone])[1], more):
            above = next((a for a in _above(bone, parents) if a in number), next(iter(number)))
            matrix = np.linalg.inv(world[bone]) @ world[above] @ inverse[number[above]]
            joints, inverse = [*joints, bone], np.concatenate([inverse, matrix[None]])
        skins[k] = joints, inverse
        assigned.update(more)
    return skins, stands if _inverse(stands)[1] else None


def _above(node: int, parents: list[int]) -> list[int]:
    """Return a node and those above it, without the scene's root."""
    chain = [node]
    while parents[node] > 0:
        chain.append(node := parents[node])
    return chain


def _unbound(
    scene: Mapping[str, NDArray], parents: list[int], world: NDArray, bones: list[int]
) -> dict[int, SceneSkin]:
    inverses = [(bone, *_inverse(world[bone])) for bone in bones]
    able = [(bone, inverse) for bone, inverse, solvable in inverses if solvable]
    places = scene["mesh_nodes"].tolist()
    free = [k for k, node in enumerate(places) if not set(_above(node, parents)) & set(bones)]
    skins = {}
    for k in (free or range(len(places))) if able else ():
        place = world[places[k]] @ scene[f"mesh_{k}_place"]
        skins[k] = [bone for bone, _ in able], np.array([matrix @ place for _, matrix in able])
    return skins


def _inverse(matrix: NDArray) -> tuple[NDArray, bool]:
    solvable = np.isfinite(matrix).all() and abs(np.linalg.det(matrix)) > 1e-300
    return (np.linalg.inv(matrix) if solvable else matrix), bool(solvable)
