"""The base colours of a glTF document's materials: factors, vertex colours, where images lie."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import CutcellError, FileError
from ...runtime.colors import srgb
from ..gltf.container import Document
from ..gltf.read.accessors import read_accessor
from ..gltf.read.primitives import attributes
from .face_colors import BLENDED, OPAQUE, Collected, FaceColors
from .gltf_textures import extension, layer, places, stored_image, wrap

MALFORMED = (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError)
"""What reading raises where a document is not what it says."""


class _Base(NamedTuple):
    """What a material says of its base colour."""

    factor: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)
    texture: Any = None
    material: Any = None
    """The whole of it; None where the primitive names none."""

    @property
    def blended(self) -> bool:
        return bool(self.material) and self.material.get("alphaMode") == "BLEND"


def _base(document: Document, primitive: dict[str, Any]) -> _Base:
    if "material" not in primitive:
        return _Base()
    material = document.item("materials", primitive["material"], "a primitive")
    older = extension(material, "KHR_materials_pbrSpecularGlossiness")
    said = older or material.get("pbrMetallicRoughness") or {}
    prefix = "diffuse" if older else "baseColor"
    factor = np.clip(np.array(said.get(f"{prefix}Factor", (1, 1, 1, 1)), np.float64), 0, 1)
    if factor.shape != (4,):
        raise FileError(f'a material\'s "{prefix}Factor" must be four numbers')
    return _Base(tuple(factor.tolist()), said.get(f"{prefix}Texture"), material)


def is_coloured(document: Document, drawn: Iterable[dict[str, Any]]) -> bool:
    """Tell whether primitives are coloured: by an image, by vertex, or not in one grey alone."""
    factors = set()
    for primitive in drawn:
        try:
            found = _base(document, primitive)
        except (CutcellError, *MALFORMED):
            continue
        if found.texture or "COLOR_0" in attributes(primitive, "the document"):
            return True
        factors.add(found.factor[:3])
    return len(factors) > 1 or any(len(set(factor)) > 1 for factor in factors)


class PrimitivePaint:
    """Colours primitives, one after the other; see `face_colors.Paint`."""

    def __init__(self, document: Document, found: Collected) -> None:
        self.document, self.found = document, found

    def __call__(self, primitive: dict[str, Any], at: NDArray, colors: FaceColors) -> None:
        """Fill the rows of one primitive; `at` are its vertices by its own numbers."""
        try:
            base = _base(self.document, primitive)
        except (CutcellError, *MALFORMED) as error:
            self._note(primitive, error)
            return
        factor = np.array(base.factor)
        corners = colors.corners
        if base.material is not None:
            name = base.material.get("name")
            named = name if isinstance(name, str) else ""
            colors.materials[:] = self.found.material(primitive["material"], named)
        self._fill(colors, base, factor)
        try:
            if "COLOR_0" in attributes(primitive, "a primitive"):
                self._fill(colors, base, factor * self._vertex_colors(primitive)[at])
        except (CutcellError, *MALFORMED) as error:
            self._note(primitive, error)
        try:
            if base.texture:
                texture = self.document.item("textures", base.texture["index"], "a material")
                uv = places(self.document, primitive, base.texture)[at]
                corners[..., 3] += wrap(self.document, texture)
                corners[..., 2] = self._layer(texture, base)
                corners[..., :2] = uv
        except (CutcellError, *MALFORMED) as error:
            self._note(primitive, error)

    def _fill(self, colors: FaceColors, base: _Base, rgba: NDArray) -> None:
        colors.tints[:] = srgb(rgba[..., :3])
        if base.blended:
            alpha = np.clip(np.nan_to_num(rgba[..., 3]), 0, 1)
            colors.opacity[:] = np.round(OPAQUE * alpha)
            colors.corners[..., 3] = BLENDED

    def _note(self, primitive: dict[str, Any], error: Exception) -> None:
        material = primitive.get("material")
        try:
            label = self.document.label("materials", material)  # type: ignore[arg-type]
        except CutcellError:
            label = "a material"
        self.found.note(label, error)

    def _vertex_colors(self, primitive: dict[str, Any]) -> NDArray:
        index = primitive["attributes"]["COLOR_0"]
        kind = self.document.item("accessors", index, "COLOR_0").get("type")
        kind = kind if kind in ("VEC3", "VEC4") else "VEC4"
        found = read_accessor(self.document, index, kind, "COLOR_0")
        return found if kind == "VEC4" else np.pad(found, ((0, 0), (0, 1)), constant_values=1)

    def _layer(self, texture: dict[str, Any], base: _Base) -> int:
        """Return the number of the use of a texture's image by a material."""
        use = layer(self.document, texture, base.material, base.factor[3])
        return self.found.layer(use, lambda: stored_image(self.document, use.image))
