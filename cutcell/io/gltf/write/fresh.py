"""A new glTF file for a rig that did not come from one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gl
from numpy.typing import NDArray

from .... import __version__
from ....errors import CutcellError, FileError, MeshError, SkeletonError, WeightsError
from ....geometry.triangles import normals
from ....rig.rig import Clip, Rig, Skeleton, TriangleMesh
from ....rig.transforms import relative
from ...deforming import KEY
from ...materials.gltf_colored import with_rig_colors
from ..container import Document, json_bytes, pack_glb, with_whole_names
from ..nodes import decompose
from ..read.influences import pack_influences
from .buffer_file import buffer_file, relative_uri

CODES = {"f": gl.FLOAT, "u1": gl.UNSIGNED_BYTE, "u2": gl.UNSIGNED_SHORT, "u4": gl.UNSIGNED_INT}
MAX_JOINTS = 2**16
MAX_SHIFT = 1e-3
"""How far rounding to 32 bits may move a point, in sizes of the mesh."""
KINDS = {1: gl.SCALAR, 3: gl.VEC3, 4: gl.VEC4, 16: gl.MAT4}


def new_files(rig: Rig, path: Path) -> dict[Path, bytes]:
    """Return the files of a rig: mesh, normals, skin, joints as nodes, clips, attachments.

    The base colours of the rig's file are taken along; see `materials.read_materials`.

    `check_fits` says whether the rig can become one.
    """
    if rig.weights is None:
        raise WeightsError("the rig has no weights to save; bind it first")
    file = _File()
    file.add_rig(rig)
    document, data = file.packed()
    colored = with_rig_colors(document, data, rig)
    if colored is not None:
        data = colored.finish()
    if path.suffix.lower() != ".gltf":
        return {path: pack_glb(json_bytes(document), data, [])}
    buffer = buffer_file(path, Document(path, document, [data]))
    document["buffers"][0]["uri"] = relative_uri(buffer)
    return {buffer: data, path: json_bytes(document)}


def check_fits(rig: Rig) -> None:
    """Refuse a rig that a new GLB cannot hold."""
    if len(rig.skeleton.joints) > MAX_JOINTS:
        raise SkeletonError(
            f"glTF numbers at most {MAX_JOINTS:,} joints, and the skeleton has "
            f"{len(rig.skeleton.joints):,}; save it as .npz or .txt"
        )
    meshes = {"its mesh": rig.mesh}
    meshes |= {f'the attachment "{one.name}"': one.mesh for one in rig.attachments}
    for what, mesh in meshes.items():
        _check_places(mesh.vertices, mesh, what, MeshError)
    _check_places(rig.skeleton.joints, rig.mesh, "its skeleton", SkeletonError)


def _check_places(
    points: NDArray, mesh: TriangleMesh, what: str, error: type[CutcellError]
) -> None:
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


class _File:
    """A document under construction, and its one buffer."""

    def __init__(self) -> None:
        self.gltf = gl.GLTF2(asset=gl.Asset(version="2.0", generator=f"cutcell {__version__}"))
        self.gltf.scene = 0
        self.data = bytearray()

    def add_rig(self, rig: Rig) -> None:
        joints = len(rig.skeleton.joints)
        self._add_joints(rig)
        # glTF's own default material is metal, which looks black without surroundings.
        plain = gl.PbrMetallicRoughness(
            baseColorFactor=[0.8, 0.8, 0.8, 1.0], metallicFactor=0.0, roughnessFactor=0.8
        )
        self.gltf.materials = [
            gl.Material(
                name="plain",
                pbrMetallicRoughness=plain,
                doubleSided=True,
                emissiveFactor=None,
                alphaMode=None,
                alphaCutoff=None,
            )
        ]
        primitive = self._primitive(rig.mesh)
        small = np.uint8 if joints <= 256 else np.uint16
        for n, (where, share) in enumerate(zip(*pack_influences(rig.weights), strict=True)):  # type: ignore[arg-type]
            target = gl.ARRAY_BUFFER
            setattr(primitive.attributes, f"JOINTS_{n}", self._array(where.astype(small), target))
            setattr(primitive.attributes, f"WEIGHTS_{n}", self._array(share, target))
        self.gltf.meshes.append(gl.Mesh(name=rig.name, primitives=[primitive]))
        binds = inverses(rig.skeleton)
        stored = self._array(binds.transpose(0, 2, 1).reshape(-1, 16).astype(np.float32))
        deform = {KEY: rig.skeleton.deform.tolist()}
        skin = gl.Skin(inverseBindMatrices=stored, joints=list(range(joints)), extras=deform)
        self.gltf.skins = [skin]
        mesh_node = self._node(name=rig.name, mesh=0, skin=0)
        self._add_attachments(rig)
        self.gltf.scenes = [gl.Scene(nodes=[joints, mesh_node])]
        for clip in rig.clips:
            self._add_clip(rig, clip)

    def _node(self, **fields: Any) -> int:
        self.gltf.nodes.append(gl.Node(**fields))
        return len(self.gltf.nodes) - 1

    def _add_joints(self, rig: Rig) -> None:
        """Add a node a joint, in order, and one above the roots that carries the world."""
        for node in joint_nodes(rig.skeleton, 0):
            self._node(**{"children": [], **node})
        top = len(self.gltf.nodes) - 1
        if not np.array_equal(rig.world, np.eye(4)):
            self.gltf.nodes[top].matrix = rig.world.T.ravel().tolist()

    def _add_attachments(self, rig: Rig) -> None:
        for attachment in rig.attachments:
            primitive = self._primitive(attachment.mesh)
            self.gltf.meshes.append(gl.Mesh(name=attachment.name, primitives=[primitive]))
            node = self._node(
                name=attachment.name,
                mesh=len(self.gltf.meshes) - 1,
                **_transform(inverses(rig.skeleton)[attachment.joint]),
            )
            self.gltf.nodes[attachment.joint].children.append(node)

    def _primitive(self, mesh: TriangleMesh) -> gl.Primitive:
        positions = mesh.vertices.astype(np.float32)
        found = gl.Attributes(
            POSITION=self._array(positions, gl.ARRAY_BUFFER, bounds=True),
            NORMAL=self._array(vertex_normals(mesh), gl.ARRAY_BUFFER),
        )
        corners = mesh.faces.reshape(-1, 1).astype(np.uint32)
        if len(positions) < 65535:
            corners = corners.astype(np.uint16)
        indices = self._array(corners, gl.ELEMENT_ARRAY_BUFFER)
        return gl.Primitive(attributes=found, indices=indices, material=0)

    def _add_clip(self, rig: Rig, clip: Clip) -> None:
        animation = gl.Animation(name=clip.name)
        times = self._array(clip.times[:, None].astype(np.float32), bounds=True)
        for path, values in _local_poses(rig, clip).items():
            for j in range(values.shape[1]):
                output = self._array(values[:, j].astype(np.float32))
                animation.samplers.append(gl.AnimationSampler(input=times, output=output))
                target = gl.AnimationChannelTarget(node=j, path=path)
                sampler = len(animation.samplers) - 1
                animation.channels.append(gl.AnimationChannel(sampler=sampler, target=target))
        self.gltf.animations.append(animation)

    def _array(self, values: NDArray, target: int | None = None, bounds: bool = False) -> int:
        """Append an array to the buffer and return its accessor."""
        self.data += b"\0" * (-len(self.data) % 4)
        view = gl.BufferView(
            buffer=0, byteOffset=len(self.data), byteLength=values.nbytes, target=target
        )
        self.data += np.ascontiguousarray(values).tobytes()
        self.gltf.bufferViews.append(view)
        accessor = gl.Accessor(
            bufferView=len(self.gltf.bufferViews) - 1,
            componentType=CODES[values.dtype.str[1:] if values.dtype.kind == "u" else "f"],
            count=len(values),
            type=KINDS[values.shape[1]],
            normalized=None,
        )
        if bounds:
            accessor.min = values.min(axis=0).tolist()
            accessor.max = values.max(axis=0).tolist()
        self.gltf.accessors.append(accessor)
        return len(self.gltf.accessors) - 1

    def packed(self) -> tuple[dict[str, Any], bytes]:
        """Return the document and its buffer."""
        self.data += b"\0" * (-len(self.data) % 4)
        self.gltf.buffers = [gl.Buffer(byteLength=len(self.data))]
        try:
            document = json.loads(self.gltf.gltf_to_json())
        except ValueError as e:  # such as a scale of the scene that is no number
            raise FileError(f"it cannot be written as JSON: {e}") from None
        return with_whole_names(document), bytes(self.data)


def vertex_normals(mesh: TriangleMesh) -> NDArray[np.float32]:
    """Return unit normals, shape (n, 3): faces weighted by area, equal positions together."""
    area = normals(mesh.vertices[mesh.faces])
    _, same = np.unique(mesh.vertices, axis=0, return_inverse=True)
    same = same.reshape(-1)
    summed = np.zeros((same.max() + 1, 3))
    for k in range(3):
        np.add.at(summed, same[mesh.faces[:, k]], area)
    summed /= np.abs(summed).max() or 1.0
    length = np.linalg.norm(summed, axis=1, keepdims=True)
    # Any direction does for a vertex without a face; glTF only asks for unit length.
    unit = np.where(length > 1e-12, summed / np.maximum(length, 1e-12), [0.0, 1.0, 0.0])
    return unit[same].astype(np.float32)


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
    """Return the inverse bind matrices; their linear parts are orthogonal."""
    matrices = bind_frames(skeleton)
    matrices[:, :3, :3] = matrices[:, :3, :3].transpose(0, 2, 1)
    matrices[:, :3, 3:] = -matrices[:, :3, :3] @ matrices[:, :3, 3:]
    return matrices


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
