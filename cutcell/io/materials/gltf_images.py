"""Taking a document's image files along when it moves."""

from __future__ import annotations

import mimetypes
import os
from pathlib import Path
from typing import Any

from ...errors import FileError
from ..gltf.buffer import BufferWriter
from ..gltf.container import Document, beside

SIGNATURES = {
    b"\x89PNG": "image/png",
    b"\xff\xd8\xff": "image/jpeg",
    b"RIFF": "image/webp",
    b"\xabKTX": "image/ktx2",
}


def carry_images(buffer: BufferWriter, document: Document, target: Path) -> dict[Path, bytes]:
    """Keep images that lie in files of their own reachable from the new document.

    A ``.gltf`` that becomes a ``.glb``, or a ``.glb`` that moves, takes them in; a ``.gltf``
    that moves takes them along. A file that is not there is left as it is named.
    """
    source = document.path
    moved = os.path.realpath(source.parent) != os.path.realpath(target.parent)
    to_text = target.suffix.lower() == ".gltf"
    if not moved and (to_text or document.binary):
        return {}
    files: dict[Path, bytes] = {}
    for image in buffer.document.get("images", []):
        uri = image.get("uri")
        if not isinstance(uri, str) or uri.startswith("data:"):
            continue
        found, goal = beside(source, uri), beside(target, uri)
        content = None if found is None else _content(found)
        if found is None or goal is None or content is None:
            continue
        if not to_text:
            _embed(buffer, image, found.name, content)
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


def _embed(buffer: BufferWriter, image: dict[str, Any], name: str, content: bytes) -> None:
    signed = next((m for s, m in SIGNATURES.items() if content.startswith(s)), None)
    kind = image.get("mimeType") or signed or mimetypes.guess_type(name)[0]
    if kind is None:
        return
    del image["uri"]
    image.setdefault("name", Path(name).stem)
    image["mimeType"] = kind
    image["bufferView"] = buffer.add_view(content)
