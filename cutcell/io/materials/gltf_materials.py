"""The base colours of a glTF document's materials: factors, vertex colours, textures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import CutcellError, FileError
from ...runtime.colors import srgb
from ..gltf.container import Document, extensions, read_uri
from ..gltf.read.primitives import Primitive
from .face_colors import (
    BLENDED,
    CLAMP,
    CUTOFF,
    MIRROR,
    OPAQUE,
    REPEAT,
    Collected,
    FaceColors,
    Layer,
    StoredImage,
)

MALFORMED = (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError)
"""Errors of reading a malformed document."""
WRAPS = {33071: CLAMP, 33648: MIRROR}
"""glTF's numbers for these; any other repeats."""
WRAP_KEYS = ("wrapS", "wrapT")
NEAREST = 9728


class _Base(NamedTuple):
    """The base colour of a material."""

    factor: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)
    texture: Any = None
    material: Any = None  # the whole of it; None where the primitive names none

    @property
    def blended(self) -> bool:
        return bool(self.material) and self.material.get("alphaMode") == "BLEND"


def _base(primitive: Primitive) -> _Base:
    if "material" not in primitive.json:
        return _Base()
    material = primitive.document.item("materials", primitive.json["material"], "a primitive")
    older = extension(material, "KHR_materials_pbrSpecularGlossiness")
    parameters = older or material.get("pbrMetallicRoughness") or {}
    prefix = "diffuse" if older else "baseColor"
    factor = np.clip(np.array(parameters.get(f"{prefix}Factor", (1, 1, 1, 1)), np.float64), 0, 1)
    if factor.shape != (4,):
        raise FileError(f'a material\'s "{prefix}Factor" must be four numbers')
    return _Base(tuple(factor.tolist()), parameters.get(f"{prefix}Texture"), material)


def is_coloured(drawn: Iterable[Primitive]) -> bool:
    """Return whether primitives are coloured: by an image, by vertex, or not in one grey alone."""
    factors = set()
    for primitive in drawn:
        try:
            base = _base(primitive)
        except (CutcellError, *MALFORMED):
            continue
        if base.texture or "COLOR_0" in primitive.attributes:
            return True
        factors.add(base.factor[:3])
    return len(factors) > 1 or any(len(set(factor)) > 1 for factor in factors)


def paint_primitive(
    collected: Collected, primitive: Primitive, at: NDArray, colors: FaceColors
) -> None:
    """Fill the rows of a primitive; `at` are its vertices by its own numbers; see `Paint`."""
    document = primitive.document
    with _noted(collected, primitive):
        base, corners = _base(primitive), colors.corners
        if base.material is not None:
            name = base.material.get("name")
            named = name if isinstance(name, str) else ""
            colors.materials[:] = collected.material(primitive.json["material"], named)
        _fill(colors, base, np.array(base.factor))
        with _noted(collected, primitive):
            if "COLOR_0" in primitive.attributes:
                _fill(colors, base, base.factor * _vertex_colors(primitive)[at])
        with _noted(collected, primitive):
            if base.texture:
                texture = document.item("textures", base.texture["index"], "a material")
                uv = places(primitive, base.texture)[at]
                sampler: dict[str, Any] = {}
                if "sampler" in texture:
                    sampler = document.item("samplers", texture["sampler"], "a texture")
                across, down = (WRAPS.get(sampler.get(key, 0), REPEAT) for key in WRAP_KEYS)
                corners[..., 3] += 3 * across + down
                use = _layer(texture, sampler, base)
                stored = partial(stored_image, document, use.image)
                corners[..., 2], corners[..., :2] = collected.layer(use, stored), uv


@contextmanager
def _noted(collected: Collected, primitive: Primitive) -> Iterator[None]:
    """Note what cannot be read of a material, and go on without it."""
    try:
        yield
    except (CutcellError, *MALFORMED) as error:
        label, material = "a material", primitive.json.get("material")
        with suppress(CutcellError):
            label = primitive.document.label("materials", material)  # type: ignore[arg-type]
        collected.note(label, error)


def _fill(colors: FaceColors, base: _Base, rgba: NDArray) -> None:
    colors.tints[:] = srgb(rgba[..., :3])
    if base.blended:
        alpha = np.clip(np.nan_to_num(rgba[..., 3]), 0, 1)
        colors.opacity[:] = np.round(OPAQUE * alpha)
        colors.corners[..., 3] = BLENDED


def _layer(texture: dict[str, Any], sampler: dict[str, Any], base: _Base) -> Layer:
    """Return the use of a texture's image by a material."""
    source = extension(texture, "EXT_texture_webp").get("source", texture.get("source"))
    if source is None:
        raise FileError("its image is in a format that is not read (PNG, JPEG and WebP are)")
    cutoff = None
    if base.material.get("alphaMode") == "MASK":  # the image's alpha is times the factor's
        cutoff = float(base.material.get("alphaCutoff", CUTOFF)) / max(base.factor[3], 1e-3)
    return Layer(source, sampler.get("magFilter") == NEAREST, cutoff, base.blended)


def _vertex_colors(primitive: Primitive) -> NDArray:
    stored = primitive.document.item("accessors", primitive.attributes["COLOR_0"], "COLOR_0")
    kind = "VEC3" if stored.get("type") == "VEC3" else "VEC4"
    values = primitive.accessor("COLOR_0", kind).values
    return values if kind == "VEC4" else np.pad(values, ((0, 0), (0, 1)), constant_values=1)


def extension(owner: dict[str, Any], name: str) -> dict[str, Any]:
    """Return what an object says by an extension; empty if nothing."""
    value = extensions(owner).get(name)
    return value if isinstance(value, dict) else {}


def places(primitive: Primitive, info: dict[str, Any]) -> NDArray:
    """Return the position of each vertex of a primitive in a material's image, shape (n, 2)."""
    moved = extension(info, "KHR_texture_transform")
    name = f"TEXCOORD_{moved.get('texCoord', info.get('texCoord', 0))}"
    if name not in primitive.attributes:
        raise FileError(f"its mesh has no {name}")
    uv = primitive.accessor(name, "VEC2").values.astype(np.float64)
    uv = np.where(np.isfinite(uv).all(axis=1, keepdims=True), uv, 0)
    if not moved:
        return uv
    angle = float(moved.get("rotation", 0))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return uv * moved.get("scale", (1, 1)) @ turn + moved.get("offset", (0, 0))


def stored_image(document: Document, number: Any) -> StoredImage:
    """Return an image as it is stored."""
    image = document.item("images", number, "a texture")
    name = document.label("images", number)
    if "uri" in image:
        return StoredImage(name, read_uri(document.path, image["uri"], name))
    view = document.item("bufferViews", image.get("bufferView"), name)
    buffer, start, length = document.view_range(view, name)
    if not length:
        raise FileError(f"{name} is empty")
    return StoredImage(name, buffer[start : start + length])
