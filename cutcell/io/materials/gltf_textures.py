"""Images of a glTF document: where they lie, how materials use them, where vertices lie in them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError
from ..gltf.container import Document, read_uri, whole
from ..gltf.read.accessors import read_accessor
from ..gltf.read.primitives import attributes
from .face_colors import CLAMP, CUTOFF, MIRROR, REPEAT, Layer, StoredImage

WRAPS = {33071: CLAMP, 33648: MIRROR}
"""glTF's numbers for these; any other repeats."""
NEAREST = 9728


def extension(owner: dict[str, Any], name: str) -> dict[str, Any]:
    """Return what an object says by an extension; empty if nothing."""
    extensions = owner.get("extensions")
    found = extensions.get(name) if isinstance(extensions, dict) else None
    return found if isinstance(found, dict) else {}


def places(document: Document, primitive: dict[str, Any], info: dict[str, Any]) -> NDArray:
    """Return where each vertex of a primitive lies in a material's image, shape (n, 2)."""
    moved = extension(info, "KHR_texture_transform")
    name = f"TEXCOORD_{moved.get('texCoord', info.get('texCoord', 0))}"
    named = attributes(primitive, "a primitive")
    if name not in named:
        raise FileError(f"its mesh has no {name}")
    uv = read_accessor(document, named[name], "VEC2", name).astype(np.float64)
    uv = np.where(np.isfinite(uv).all(axis=1, keepdims=True), uv, 0)
    if not moved:
        return uv
    angle = float(moved.get("rotation", 0))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return uv * moved.get("scale", (1, 1)) @ turn + moved.get("offset", (0, 0))


def wrap(document: Document, texture: dict[str, Any]) -> int:
    """Return how a texture's image goes on, 3 across + down; see `REPEAT`."""
    sampler = _sampler(document, texture)
    across, down = (WRAPS.get(sampler.get(name, 0), REPEAT) for name in ("wrapS", "wrapT"))
    return 3 * across + down


def layer(
    document: Document, texture: dict[str, Any], material: dict[str, Any], alpha: float
) -> Layer:
    """Return how a material uses a texture's image; `alpha` is what that of the image is times."""
    source = extension(texture, "EXT_texture_webp").get("source", texture.get("source"))
    if source is None:
        raise FileError("its image is in a format that is not read (PNG, JPEG and WebP are)")
    cutoff = None
    if material.get("alphaMode") == "MASK":
        cutoff = float(material.get("alphaCutoff", CUTOFF)) / max(alpha, 1e-3)
    blended = material.get("alphaMode") == "BLEND"
    nearest = _sampler(document, texture).get("magFilter") == NEAREST
    return Layer(source, nearest, cutoff, blended)


def stored_image(document: Document, number: Any) -> StoredImage:
    """Return an image as it is stored."""
    image = document.item("images", number, "a texture")
    name = document.label("images", number)
    if "uri" in image:
        return StoredImage(name, read_uri(document.path, image["uri"], name))
    view = document.item("bufferViews", image.get("bufferView"), name)
    document.item("buffers", view.get("buffer"), name)
    start, length = whole(view, "byteOffset", name, 0), whole(view, "byteLength", name)
    content = document.buffers[view["buffer"]][start : start + length]
    if not length or len(content) < length:
        raise FileError(f"{name} is cut short")
    return StoredImage(name, content)


def _sampler(document: Document, texture: dict[str, Any]) -> dict[str, Any]:
    if "sampler" not in texture:
        return {}
    return document.item("samplers", texture["sampler"], "a texture")
