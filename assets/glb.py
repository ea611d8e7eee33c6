"""Write a character as a binary glTF 2.0 file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gltf
from numpy.typing import NDArray

from .character import Bones, Character, Material, Motion, Surface, linear, rgb

_COMPONENTS = {"uint8": 5121, "uint16": 5123, "uint32": 5125, "float32": 5126}
_VERTICES, _INDICES = 34962, 34963
_INFLUENCES = 4


def save(path: Path, character: Character) -> None:
    """Write the file; the same character gives the same bytes, always."""
    path.write_bytes(to_bytes(character))


def to_bytes(character: Character) -> bytes:
    """Return the character as the bytes of a GLB file."""
    bones = character.bones
    document = gltf.GLTF2(asset=gltf.Asset(version="2.0", generator="cutcell assets"))
    blob = _Blob(document)
    inverse = np.tile(np.eye(4), (len(bones.names), 1, 1))
    inverse[:, 3, :3] = -np.array(bones.places)  # transposed: glTF stores columns
    document.nodes = [*_joint_nodes(bones), gltf.Node(name=character.name, mesh=0, skin=0)]
    roots = [k for k, parent in enumerate(bones.parents) if parent < 0]
    document.scenes = [gltf.Scene(nodes=[*roots, len(bones.names)])]
    document.scene = 0
    document.skins = [
        gltf.Skin(
            name=character.name,
            joints=list(range(len(bones.names))),
            skeleton=roots[0],
            inverseBindMatrices=blob.add(inverse.reshape(-1, 16), "MAT4"),
        )
    ]
    document.materials = [_material(surface.material) for surface in character.surfaces]
    primitives = [_primitive(blob, k, s) for k, s in enumerate(character.surfaces)]
    document.meshes = [gltf.Mesh(name=character.name, primitives=primitives)]
    document.animations = [_animation(blob, character.motion, bones)]
    document.buffers = [gltf.Buffer(byteLength=len(blob.data))]
    document.set_binary_blob(bytes(blob.data))
    return b"".join(document.save_to_bytes())


class _Blob:
    """The file's binary part, growing by one array at a time."""

    def __init__(self, document: gltf.GLTF2) -> None:
        self.document, self.data = document, bytearray()

    def add(
        self,
        array: NDArray,
        kind: str,
        dtype: str = "float32",
        target: int | None = None,
        bounds: bool = False,
    ) -> int:
        """Append an array; return the index of its accessor."""
        array = np.ascontiguousarray(array, dtype)
        self.document.bufferViews.append(
            gltf.BufferView(
                buffer=0, byteOffset=len(self.data), byteLength=array.nbytes, target=target
            )
        )
        self.data += array.tobytes() + bytes(-array.nbytes % 4)
        rows = array.reshape(len(array), -1)
        self.document.accessors.append(
            gltf.Accessor(
                bufferView=len(self.document.bufferViews) - 1,
                componentType=_COMPONENTS[dtype],
                count=len(array),
                type=kind,
                min=rows.min(axis=0).tolist() if bounds else None,
                max=rows.max(axis=0).tolist() if bounds else None,
            )
        )
        return len(self.document.accessors) - 1


def _joint_nodes(bones: Bones) -> list[gltf.Node]:
    nodes = []
    for k, (name, parent) in enumerate(zip(bones.names, bones.parents, strict=True)):
        place = bones.places[k] - (bones.places[parent] if parent >= 0 else 0)
        children = [c for c, p in enumerate(bones.parents) if p == k]
        translation = np.round(place, 6).tolist()
        nodes.append(gltf.Node(name=name, translation=translation, children=children))
    return nodes


def _material(material: Material) -> gltf.Material:
    colour = np.round(linear(rgb(material.colour)), 6).tolist()
    return gltf.Material(
        name=material.name,
        pbrMetallicRoughness=gltf.PbrMetallicRoughness(
            baseColorFactor=[*colour, 1.0],
            metallicFactor=material.metallic,
            roughnessFactor=material.roughness,
        ),
        doubleSided=material.both_sides,
        alphaCutoff=None,
    )


def _primitive(blob: _Blob, index: int, surface: Surface) -> gltf.Primitive:
    order = np.argsort(-surface.weights, axis=1, kind="stable")[:, :_INFLUENCES]
    weights = np.take_along_axis(surface.weights, order, axis=1)
    order = np.where(weights > 0, order, 0)
    attributes = gltf.Attributes(
        POSITION=blob.add(surface.vertices, "VEC3", target=_VERTICES, bounds=True),
        JOINTS_0=blob.add(order, "VEC4", "uint8", _VERTICES),
        WEIGHTS_0=blob.add(weights, "VEC4", target=_VERTICES),
    )
    if surface.normals is not None:
        attributes.NORMAL = blob.add(surface.normals, "VEC3", target=_VERTICES)
    dtype = "uint16" if len(surface.vertices) < 65535 else "uint32"
    indices = blob.add(surface.faces.ravel(), "SCALAR", dtype, _INDICES)
    return gltf.Primitive(attributes=attributes, indices=indices, material=index)


def _animation(blob: _Blob, motion: Motion, bones: Bones) -> gltf.Animation:
    times = blob.add(motion.times, "SCALAR", bounds=True)
    animation = gltf.Animation(name=motion.name)
    tracks: list[tuple[str, str, str, Any]] = [
        (name, "rotation", "VEC4", keys) for name, keys in motion.rotations.items()
    ]
    for name, keys in motion.moves.items():
        node = bones.names.index(name)
        parent = bones.parents[node]
        rest = bones.places[node] - (bones.places[parent] if parent >= 0 else 0)
        tracks.append((name, "translation", "VEC3", rest + keys))
    for name, path, kind, keys in tracks:
        output = blob.add(keys, kind)
        animation.samplers.append(gltf.AnimationSampler(input=times, output=output))
        animation.channels.append(
            gltf.AnimationChannel(
                sampler=len(animation.samplers) - 1,
                target=gltf.AnimationChannelTarget(node=bones.names.index(name), path=path),
            )
        )
    return animation
