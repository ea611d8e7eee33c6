"""Images of a glTF document that is written: embedded, converted to PNG, or copied with it."""

from __future__ import annotations

import mimetypes
import os
import warnings
from collections.abc import Sequence
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

from ...errors import FileError
from ..gltf.buffer import BufferWriter
from ..gltf.container import Document, beside
from .face_colors import StoredImage

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
