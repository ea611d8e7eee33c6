"""The base colours of a glTF document's materials: factors, vertex colours, where images lie.

Images are handed over as they are stored; nothing is decoded here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import CutcellError, FileError
from ..rig import Rig
from .gltf_accessors import read_accessor
from .gltf_container import Document
from .gltf_primitives import Drawn, attributes, primitives, read_triangles
from .gltf_read import GltfSource
from .gltf_textures import Layer, StoredImage, extension, layer, places, stored_image, wrap

BYTES_PER_FACE = 3 * (4 * 4 + 3)
MALFORMED = (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError)
"""What reading raises where a document is not what it says."""


@dataclass(frozen=True, eq=False)
class FaceColors:
    """What colours the corners of some faces.

    Parameters
    ----------
    corners : array, shape (m, 3, 4), float32
        Of each corner: where it lies in the image, from the upper left corner of it; the
        number of the layer, -1 for none; and how the image goes on, 3 across + down (see `REPEAT`).
    tints : array, shape (m, 3, 3), uint8
        What the image is multiplied by, or the colour where there is none; sRGB.
    """

    corners: NDArray[np.float32]
    tints: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Materials:
    """The base colours of a rig.

    Parameters
    ----------
    body : FaceColors
        Of the faces of `rig.mesh`.
    attachments : tuple of FaceColors
        Of those of each attachment.
    layers : tuple of Layer
    images : tuple of StoredImage
    notes : tuple of str
        What could not be read, in sentences.
    """

    body: FaceColors
    attachments: tuple[FaceColors, ...]
    layers: tuple[Layer, ...]
    images: tuple[StoredImage, ...]
    notes: tuple[str, ...] = ()


def has_materials(rig: Rig) -> bool:
    """Tell whether a rig's file colours it: by an image, by vertex, or not in one grey alone."""
    if not isinstance(rig.source, GltfSource):
        return False
    document, factors = rig.source.document, set()
    for primitive in _drawn_primitives(rig.source):
        try:
            found = _base(document, primitive)
        except (CutcellError, *MALFORMED):
            continue
        if found.texture or "COLOR_0" in attributes(primitive, "the document"):
            return True
        factors.add(found.factor[:3])
    return len(factors) > 1 or any(len(set(factor)) > 1 for factor in factors)


def read_materials(rig: Rig) -> Materials | None:
    """Return the base colours that a rig's glTF document gives it.

    What cannot be read is shown in the material's factor, or white, and told in `notes`.

    Parameters
    ----------
    rig : Rig
        Its faces may have been repaired, its joints corrected.

    Returns
    -------
    Materials or None
        None where the rig did not come from glTF, or its faces are no longer that document's.
    """
    source = rig.source
    if not isinstance(source, GltfSource) or len(source.attached) != len(rig.attachments):
        return None
    # Its own store of what was decoded: others may read the same document now, or forget.
    stored = source.document
    document = Document(stored.path, stored.json, stored.buffers, stored.size)
    reading = _Reading(document)
    body = reading.colors(rig.mesh.faces, _of_body(document, source))
    nodes = document.items("nodes")
    hung = [
        reading.colors(one.mesh.faces, _of_node(document, nodes[node], node))
        for one, node in zip(rig.attachments, source.attached, strict=True)
    ]
    found = [colors for colors in (body, *hung) if colors is not None]
    if len(found) <= len(hung):
        return None
    images = tuple(reading.images.values())
    return Materials(found[0], tuple(found[1:]), tuple(reading.layers), images, reading.notes)


def srgb(linear: ArrayLike) -> NDArray[np.uint8]:
    """Return linear colours, from 0 to 1, as they are stored in pictures."""
    values = np.clip(np.nan_to_num(np.asarray(linear, np.float64)), 0, 1)
    bent = 1.055 * values ** (1 / 2.4) - 0.055
    return np.round(255 * np.where(values <= 0.0031308, 12.92 * values, bent)).astype(np.uint8)


def _of_body(document: Document, source: GltfSource) -> Iterator[Drawn]:
    for one in source.faces:
        primitive = primitives(document, one.mesh, "the document")[one.primitive]
        yield Drawn(primitive, one.first_vertex, one.rows)


def _of_node(document: Document, node: dict[str, Any], number: int) -> list[Drawn]:
    return read_triangles(document, node["mesh"], document.label("nodes", number))[2]


def _drawn_primitives(source: GltfSource) -> Iterator[dict[str, Any]]:
    document = source.document
    nodes = document.items("nodes")
    yield from (one.primitive for one in _of_body(document, source))
    for node in source.attached:
        yield from primitives(document, nodes[node]["mesh"], document.label("nodes", node))


class _Base(NamedTuple):
    """What a material says of its base colour."""

    factor: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)
    texture: Any = None
    material: Any = None
    """The whole of it; None where the primitive names none."""


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


class _Reading:
    """Reads materials one after the other; each image, and each use of one, is listed once."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.layers: dict[Layer, int] = {}
        self.images: dict[int, StoredImage] = {}
        self._notes: dict[str, None] = {}

    @property
    def notes(self) -> tuple[str, ...]:
        return tuple(self._notes)

    def colors(self, faces: NDArray[np.int32], drawn: Iterable[Drawn]) -> FaceColors | None:
        """Return the colours of faces; None if these are not those of the primitives."""
        self.document.allowance.take(len(faces) * BYTES_PER_FACE, "its materials")
        corners = np.zeros((len(faces), 3, 4), np.float32)
        corners[..., 2] = -1
        tints = np.full((len(faces), 3, 3), 255, np.uint8)
        end = 0
        for primitive, first, rows in drawn:
            if rows.start != end or rows.stop > len(faces):
                return None
            end = rows.stop
            with np.errstate(all="ignore"):  # a file may hold any number
                self._paint(primitive, faces[rows] - first, corners[rows], tints[rows])
        np.nan_to_num(corners, copy=False)
        return FaceColors(corners, tints) if end == len(faces) else None

    def _paint(
        self, primitive: dict[str, Any], at: NDArray, corners: NDArray, tints: NDArray
    ) -> None:
        """Fill the rows of one primitive; `at` are its vertices by its own numbers."""
        try:
            base = _base(self.document, primitive)
        except (CutcellError, *MALFORMED) as error:
            self._note(primitive, error)
            return
        tint = np.array(base.factor[:3])
        tints[:] = srgb(tint)
        try:
            if "COLOR_0" in attributes(primitive, "a primitive"):
                tints[:] = srgb(tint * self._vertex_colors(primitive)[at])
        except (CutcellError, *MALFORMED) as error:
            self._note(primitive, error)
        try:
            if base.texture:
                texture = self.document.item("textures", base.texture["index"], "a material")
                uv = places(self.document, primitive, base.texture)[at]
                corners[..., 3] = wrap(self.document, texture)
                corners[..., 2] = self._layer(texture, base)
                corners[..., :2] = uv
        except (CutcellError, *MALFORMED) as error:
            self._note(primitive, error)

    def _note(self, primitive: dict[str, Any], error: Exception) -> None:
        material = primitive.get("material")
        try:
            label = self.document.label("materials", material)  # type: ignore[arg-type]
        except CutcellError:
            label = "a material"
        why = str(error) if isinstance(error, CutcellError) else "it is malformed"
        self._notes[f"{label} is shown without what could not be read of it: {why}"] = None

    def _vertex_colors(self, primitive: dict[str, Any]) -> NDArray:
        index = primitive["attributes"]["COLOR_0"]
        kind = self.document.item("accessors", index, "COLOR_0").get("type")
        kind = kind if kind in ("VEC3", "VEC4") else "VEC4"
        return read_accessor(self.document, index, kind, "COLOR_0")[:, :3]

    def _layer(self, texture: dict[str, Any], base: _Base) -> int:
        """Return the number of the use of a texture's image by a material."""
        found = layer(self.document, texture, base.material, base.factor[3])
        if found.image not in self.images:
            self.images[found.image] = stored_image(self.document, found.image)
        found = replace(found, image=list(self.images).index(found.image))
        return self.layers.setdefault(found, len(self.layers))
