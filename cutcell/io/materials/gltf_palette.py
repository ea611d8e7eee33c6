"""The colours of faces as glTF's materials, textures and images; images that go along."""

from __future__ import annotations

import mimetypes
import os
import warnings
from collections.abc import Sequence
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError
from ...runtime.colors import linear
from ..files import whole_characters
from ..gltf.buffer import BufferWriter
from ..gltf.container import Document, beside
from .face_colors import BLENDED, OPAQUE, Collected, FaceColors, Materials, StoredImage

FULL = 2**16 - 1
PLAIN = "plain"


class Group(NamedTuple):
    """Faces that have one material."""

    material: int  # in the document
    rows: NDArray[np.intp]  # (k,): the faces, ascending
    textured: bool  # whether they have texture coordinates
    varied: bool  # whether they have colours by vertex


class _MaterialKey(NamedTuple):
    """A material: number of the name, layer, whether it is blended, and factor as bytes."""

    name: int
    layer: int
    blended: bool
    factor: tuple[int, ...]


class Palette:
    """The materials of a document that is being made; `uses` has those of the faces."""

    def __init__(self, uses: Materials | Collected) -> None:
        self._uses, self._layers = uses, list(uses.layers)
        self._embedded = [embedded(image) for image in uses.images]
        self._keys: dict[_MaterialKey, int] = {}

    def groups(self, colors: FaceColors) -> tuple[list[Group], NDArray[np.float32]]:
        """Part faces by material; return them, and place and colour of corners (m, 3, 6)."""
        layers, rgba = self._visible(colors)
        # Blending matters where there is an image, or a colour that is not opaque.
        counts = (layers >= 0) | (rgba[..., 3] < OPAQUE).any(axis=1)
        blended = (colors.corners[:, 0, 3] >= BLENDED) & counts
        kinds = np.column_stack([colors.materials, layers, blended]).astype(int)
        unique, first, of_face = np.unique(kinds, axis=0, return_index=True, return_inverse=True)
        of_face = of_face.reshape(-1)
        ends = np.cumsum(np.bincount(of_face))
        faces = np.split(np.argsort(of_face, kind="stable"), ends[:-1])
        values = np.zeros((len(kinds), 3, 6), np.float32)
        values[..., 2:] = FULL
        groups = []
        for k in np.argsort(first).tolist():
            name, layer, is_blended = unique[k].tolist()
            rows, corners = faces[k], rgba[faces[k]]
            varied = bool((corners != corners[0, 0]).any())
            factor = (OPAQUE,) * 4 if varied else tuple(corners[0, 0].tolist())
            if varied:
                values[rows, :, 2:5] = np.round(FULL * linear(corners[..., :3]))
                values[rows, :, 5] = corners[..., 3] * (FULL / OPAQUE)
            if layer >= 0:
                values[rows, :, :2] = colors.corners[rows, :, :2] + 0.0  # -0 is 0
            key = _MaterialKey(name, layer, bool(is_blended), factor)
            number = self._keys.setdefault(key, len(self._keys))
            groups.append(Group(number, rows, layer >= 0, varied))
        return groups, values

    def _visible(self, colors: FaceColors) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
        """Return layers (m,), -1 for images that cannot be taken in, and colours (m, 3, 4)."""
        layers = colors.corners[:, 0, 2].astype(int)
        rgba = np.concatenate([colors.tints, colors.opacity[..., None]], axis=2)
        for k, use in enumerate(self._layers):
            if self._embedded[use.image].problem:
                rows = layers == k
                layers[rows] = -1
                if use.color is not None:
                    rgba[rows, :, :3] = use.color
        return layers, rgba

    def store(self, buffer: BufferWriter) -> int:
        """Put the materials before the one of a document, and return the number of that."""
        document = buffer.document
        document["materials"] = [*map(self._material, self._keys), *document["materials"]]
        if any(key.layer >= 0 for key in self._keys):
            self._store_images(buffer)
        return len(self._keys)

    def _store_images(self, buffer: BufferWriter) -> None:
        document = buffer.document
        images: dict[int, int] = {}
        for key, material in zip(self._keys, document["materials"], strict=False):
            if key.layer >= 0:
                number = images.setdefault(self._layers[key.layer].image, len(images))
                material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": number}
        document["images"] = []
        for k in images:
            name = whole_characters(self._uses.images[k].name).partition('"')[2].rpartition('"')[0]
            view = buffer.add_view(self._embedded[k].content)
            stored = {"bufferView": view, "mimeType": self._embedded[k].kind}
            document["images"].append({"name": name, **stored} if name else stored)
        document["textures"] = [{"source": number} for number in range(len(images))]

    def _material(self, key: _MaterialKey) -> dict[str, Any]:
        base: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 0.8}
        if key.factor != (OPAQUE,) * 4:
            *rgb, alpha = key.factor
            base["baseColorFactor"] = [*linear(rgb).tolist(), alpha / OPAQUE]
        name = whole_characters(self._uses.names[key.name]) if key.name >= 0 else PLAIN
        made: dict[str, Any] = {"name": name} if name else {}
        made |= {"pbrMetallicRoughness": base, "doubleSided": True}
        use = self._layers[key.layer] if key.layer >= 0 else None
        if key.blended or (use is not None and use.blended):
            made["alphaMode"] = "BLEND"
        elif use is not None and use.cutoff is not None:
            made |= {"alphaMode": "MASK", "alphaCutoff": use.cutoff}
        return made


SIGNATURES = {
    b"\x89PNG": "image/png",
    b"\xff\xd8\xff": "image/jpeg",
    b"RIFF": "image/webp",
    b"\xabKTX": "image/ktx2",
}

EMBEDDABLE = ("image/png", "image/jpeg")
"""Formats that every reader of glTF supports."""
CONVERTIBLE = ("WEBP", "BMP", "TGA")
MAX_PIXELS = 2**26
"""Largest image to convert: 8192 by 8192."""


class Embedded(NamedTuple):
    """An image of a GLB: its media type and bytes, or why it cannot be embedded."""

    kind: str = ""
    content: bytes = b""
    problem: str = ""


def embedded(image: StoredImage) -> Embedded:
    """Return an image as a GLB contains it: PNG and JPEG unchanged, others as PNG."""
    kind = _signed(image.content)
    if kind in EMBEDDABLE:
        return Embedded(kind, image.content)
    try:
        from PIL import Image
    except ImportError:
        return Embedded(problem="Pillow is not installed; try: pip install pillow")
    packed = BytesIO()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(BytesIO(image.content), formats=CONVERTIBLE) as picture:
                if picture.width * picture.height > MAX_PIXELS:
                    raise Image.DecompressionBombError
                mode = "RGBA" if picture.has_transparency_data else "RGB"
                picture.convert(mode).save(packed, "PNG")
    except (Image.DecompressionBombWarning, Image.DecompressionBombError, MemoryError):
        return Embedded(problem="it has more than 67 million pixels")
    except Exception:  # the readers of Pillow raise errors of any class
        return Embedded(problem="it is no PNG, JPEG, WebP, BMP or TGA, or damaged")
    return Embedded("image/png", packed.getvalue())


def _signed(content: bytes) -> str:
    """Return the media type of an image by its first bytes, empty if unknown."""
    return next((kind for start, kind in SIGNATURES.items() if content.startswith(start)), "")


def image_notes(images: Sequence[StoredImage]) -> tuple[str, ...]:
    """Return a note for each image that a GLB cannot contain."""
    return tuple(
        f"{image.name} is not saved, and its material has its colour alone: {problem}"
        for image in images
        if (problem := embedded(image).problem)
    )


def carry_images(buffer: BufferWriter, document: Document, target: Path) -> dict[Path, bytes]:
    """Keep images in separate files reachable: a ``.glb`` takes them in, a ``.gltf`` along."""
    source = document.path
    moved = os.path.realpath(source.parent) != os.path.realpath(target.parent)
    to_text = target.suffix.lower() == ".gltf"
    if not moved and (to_text or document.binary):
        return {}
    files: dict[Path, bytes] = {}
    read = cache(_content)  # many images may be of one file
    views: dict[bytes, int] = {}
    for image in buffer.document.get("images", []):
        uri = image.get("uri")
        if not isinstance(uri, str) or uri.startswith("data:"):
            continue
        file, goal = beside(source, uri), beside(target, uri)
        content = None if file is None else read(file)
        if file is None or goal is None or content is None:
            continue
        if not to_text:
            _embed(buffer, image, file.name, content, views)
        elif not os.path.lexists(goal):
            files[goal] = content
        elif _content(goal) != content:
            raise FileError(
                f"its image {uri} would replace another file of that name; save it in another "
                "folder, or as .glb, which takes images in"
            )
    return files


def _content(file: Path) -> bytes | None:
    """Return what is in a file; None if it is not there, or none that can be read."""
    try:
        return file.read_bytes()
    except (OSError, ValueError):
        return None


def _embed(
    buffer: BufferWriter, image: dict[str, Any], name: str, content: bytes, views: dict[bytes, int]
) -> None:
    kind = image.get("mimeType") or _signed(content) or mimetypes.guess_type(name)[0]
    if kind is None:
        return
    del image["uri"]
    image.setdefault("name", Path(name).stem)
    image["mimeType"] = kind
    if content not in views:
        views[content] = buffer.add_view(content)
    image["bufferView"] = views[content]
