"""New glTF documents, and a skeleton for a document whose meshes have none."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .... import __version__
from ....errors import MeshError, SkeletonError
from ....rig import Clip, Rig, Skeleton, TriangleMesh
from ....rig.transforms import relative
from ...materials.gltf_colored import with_rig_looks
from ...materials.surfaces import vertex_normals
from ...weights import DEFORM_KEY
from ..buffer import BufferWriter, GltfBuilder
from ..container import Document, extensions, with_whole_names
from ..influences import influence_attributes, pack_influences, store_deform
from ..nodes import Nodes, decompose
from ..read.added_skins import add_skins
from ..read.primitives import primitives
from ..read.read import BareSource, read_rig
from ..read.skins import Bind
from .write import packed, rewritten

MAX_GLTF_JOINTS = 2**16
MAX_SHIFT = 1e-3
"""How far rounding to 32 bits may move a point, in sizes of the mesh."""


def new_files(rig: Rig, path: Path) -> dict[Path, bytes]:
    """Return the files of a rig for which `check_fits` was called, coloured by its own file."""
    buffer = with_rig_looks(*_document(rig), rig)
    return packed(buffer, Document(path, {}, []), path, {})


def check_fits(rig: Rig) -> None:
    """Refuse a rig that a new GLB cannot hold."""
    if len(rig.skeleton.joints) > MAX_GLTF_JOINTS:
        raise SkeletonError(
            f"glTF numbers at most {MAX_GLTF_JOINTS:,} joints, and the skeleton has "
            f"{len(rig.skeleton.joints):,}; save it as .npz or .txt"
        )
    meshes = {"its mesh": rig.mesh}
    meshes |= {f'the attachment "{one.name}"': one.mesh for one in rig.attachments}
    for what, mesh in meshes.items():
        _check_places(mesh.vertices, mesh, what, MeshError)
    _check_places(rig.skeleton.joints, rig.mesh, "its skeleton", SkeletonError)


def _check_places(points: NDArray, mesh: TriangleMesh, what: str, error: type[Exception]) -> None:
    """Refuse points that would move by much, for a mesh's size, when they are stored as float32."""
    with np.errstate(over="ignore"):
        size = np.ptp(mesh.bounds, axis=0).max()
        stored = points.astype(np.float32).astype(np.float64)
    shifts = np.abs(stored - points).max(axis=1, initial=0)
    bad = np.flatnonzero(~(np.isfinite(stored).all(axis=1) & (shifts <= MAX_SHIFT * size)))
    if len(bad):
        x, y, z = points[bad[0]]
        raise error(
            f"glTF's numbers have 32 bits: {what} at ({x:.4g}, {y:.4g}, {z:.4g}) would move by "
            "more than a thousandth of the mesh's size; scale it or move it to the origin, or save "
            "it as .npz or .txt"
        )


def _document(rig: Rig) -> tuple[dict[str, Any], bytes]:
    """Return the document of a rig, in one plain material, and its buffer."""
    builder, count = GltfBuilder(f"cutcell {__version__}"), len(rig.skeleton.joints)
    for joint in joint_nodes(rig.skeleton, 0):
        builder.add_node(joint)
    if not np.array_equal(rig.world, np.eye(4)):
        builder.json["nodes"][count]["matrix"] = rig.world.T.ravel().tolist()
    attributes = _attributes(builder, rig.mesh)
    influences = influence_attributes(pack_influences(rig.weights), count)  # type: ignore[arg-type]
    attributes |= {name: builder.buffer.store(one) for name, one in influences.items()}
    mesh = builder.add_mesh(rig.name, attributes, rig.mesh.faces)
    binds, deform = inverses(rig.skeleton), {DEFORM_KEY: rig.skeleton.deform.tolist()}
    skin = builder.add_skin(list(range(count)), binds, extras=deform)
    node = builder.add_node({"name": rig.name, "mesh": mesh, "skin": skin})
    builder.json["scenes"] = [{"nodes": [count, node]}]
    for one in rig.attachments:
        mesh = builder.add_mesh(one.name, _attributes(builder, one.mesh), one.mesh.faces)
        at_rest = _transform(binds[one.joint])
        builder.add_node({"name": one.name, "mesh": mesh, **at_rest}, one.joint)
    for clip in rig.clips:
        add_clip(builder, rig, clip)
    data = builder.buffer.finish()
    return with_whole_names(builder.json), data


def _attributes(builder: GltfBuilder, mesh: TriangleMesh) -> dict[str, int]:
    return {
        "POSITION": builder.floats(mesh.vertices, bounds=True),
        "NORMAL": builder.floats(vertex_normals(mesh.vertices, mesh.faces)),
    }


def add_clip(builder: GltfBuilder, rig: Rig, clip: Clip, first: int = 0) -> None:
    """Add a clip of joints that are nodes from `first` on, see `joint_nodes`."""
    animation: dict[str, Any] = {"name": clip.name, "channels": [], "samplers": []}
    times = builder.floats(clip.times[:, None], target=None, bounds=True)
    for path, values in _local_poses(rig, clip).items():
        for j in range(values.shape[1]):
            builder.add_track(animation, first + j, path, times, values[:, j])
    builder.add("animations", animation)


def joint_nodes(skeleton: Skeleton, first: int) -> list[dict[str, Any]]:
    """Return a node for each joint, numbered from `first` on, and one above the roots."""
    local = relative(bind_frames(skeleton), skeleton.parents)
    roots = np.flatnonzero(skeleton.parents < 0)
    named = [*zip(skeleton.names, skeleton.children, strict=True), ("armature", roots)]
    nodes: list[dict[str, Any]] = [
        {"name": name, **({"children": (first + below).tolist()} if len(below) else {})}
        for name, below in named
    ]
    for node, matrix in zip(nodes, local, strict=False):
        node.update(_transform(matrix))
    return nodes


def bind_frames(skeleton: Skeleton) -> NDArray:
    """Return where each joint is at rest and how it is turned, shape (j, 4, 4)."""
    matrices = np.tile(np.eye(4), (len(skeleton.joints), 1, 1))
    if skeleton.orientations is not None:
        matrices[:, :3, :3] = skeleton.orientations
    matrices[:, :3, 3] = skeleton.joints
    return matrices


def inverses(skeleton: Skeleton) -> NDArray:
    """Return the inverse bind matrices."""
    return np.linalg.inv(bind_frames(skeleton))


def _transform(matrix: NDArray) -> dict[str, list[float]]:
    """Return a node's fields for a matrix without shear; what is left out is the identity's."""
    translation, rotation, scale = decompose(matrix)
    fields = {"translation": translation.tolist()}
    if not np.allclose(matrix[:3, :3], np.eye(3), rtol=0, atol=1e-12):
        fields["rotation"] = (rotation * (-1 if rotation[3] < 0 else 1)).tolist()
    if scale[0] < 0:  # a joint whose axes are mirrored
        fields["scale"] = [-1.0, 1.0, 1.0]
    return fields


def _local_poses(rig: Rig, clip: Clip) -> dict[str, NDArray]:
    """Return what each joint's node does, relative to its parent's node."""
    world = clip.transforms @ bind_frames(rig.skeleton)
    translation, rotation, scale = decompose(relative(world, rig.skeleton.parents))
    turned = (rotation[1:] * rotation[:-1]).sum(axis=-1) < 0
    flips = np.concatenate([np.zeros((1, turned.shape[1]), bool), turned]).cumsum(axis=0) % 2
    poses = {"translation": translation, "rotation": rotation * np.where(flips, -1, 1)[..., None]}
    if np.abs(scale - 1).max() > 1e-6:
        poses["scale"] = scale
    return poses


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
    owner = source.document.json["nodes"][node]
    of_triangles = all(one.draws_triangles for one in primitives(source.document, owner["mesh"]))
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
