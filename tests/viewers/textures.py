"""A wall in front of the camera with an image on it, as a glTF file and by an oracle."""

import io

import numpy as np
from PIL import Image

from tests.cutcell.io.gltf.gltf_builder import Builder, moved

COLORS = np.array([[[220, 40, 40], [40, 200, 40]], [[50, 60, 220], [230, 220, 60]]], np.uint8)
"""Two by two pixels: red, green; blue, yellow."""


def png(pixels, kind="PNG", **options):
    """Return pixels as a file."""
    stream = io.BytesIO()
    Image.fromarray(np.asarray(pixels, np.uint8)).save(stream, kind, **options)
    return stream.getvalue()


def squares(side=64):
    """Return `COLORS` as a larger image, shape (side, side, 3)."""
    return np.kron(COLORS, np.ones((side // 2, side // 2, 1), np.uint8))


def wall(content, low=(0.0, 0.0), high=(1.0, 1.0), sampler=None, **material):
    """Return a builder with a thick wall on two joints; its front shows an image from low to high.

    Its upper left corner has the coordinates `low`, the lower right one `high`.
    """
    builder = Builder()
    root = builder.node(name="root", translation=[0, -1, 0])
    builder.node(root, name="tip", translation=[0, 1, 0])
    skin = builder.skin([0, 1], [moved(0, 1, 0), moved(0, 0, 0)])
    front = np.array([[-1, 1, 0.2], [1, 1, 0.2], [1, -1, 0.2], [-1, -1, 0.2]])
    points = np.concatenate([front, front * (1, 1, -1)]).astype("f4")
    (left, top), (right, bottom) = low, high
    uv = [[left, top], [right, top], [right, bottom], [left, bottom]] * 2
    faces = [[0, 3, 2], [0, 2, 1], [4, 6, 7], [4, 5, 6]]
    faces += [[k, (k + 1) % 4, k + 4] for k in range(4)]
    faces += [[(k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)]
    shares = np.zeros((8, 4), "f4")
    upper = points[:, 1] > 0
    shares[upper, 1], shares[~upper, 0] = 1, 1
    joints = np.zeros((8, 4), "u1")
    joints[:, 1] = 1
    attributes = builder.attributes(points, joints, shares)
    attributes["TEXCOORD_0"] = builder.accessor(np.array(uv, "f4"))
    mesh = builder.mesh(attributes, np.array(faces))
    image = builder.add("images", {"name": "wall", "bufferView": builder.view(content)})
    builder.json["images"][image]["mimeType"] = "image/png"
    texture = {"source": image}
    if sampler:
        texture["sampler"] = builder.add("samplers", sampler)
    number = builder.add("textures", texture)
    pbr = {"baseColorTexture": {"index": number}, **material.pop("pbr", {})}
    part = builder.json["meshes"][mesh]["primitives"][0]
    part["material"] = builder.add("materials", {"pbrMetallicRoughness": pbr, **material})
    builder.node(name="wall", mesh=mesh, skin=skin)
    return builder


def seen(u, v, sampler=None):
    """Return the colour that `squares` have at a place, by glTF's rules of wrapping."""
    sampler = sampler or {}

    def wrapped(at, how):
        if how == 33071:
            return np.clip(at, 0, 1 - 1e-9)
        if how == 33648:
            at = at % 2
            return 2 - at - 1e-9 if at >= 1 else at
        return at % 1

    column = int(2 * wrapped(u, sampler.get("wrapS")))
    row = int(2 * wrapped(v, sampler.get("wrapT")))
    return COLORS[row, column]
