"""Giving decompressed bytes a place in a document that was just read."""

from __future__ import annotations

from typing import Any

from ..container import Document

ALIGNMENT = 8
PLAIN_NAMES = {
    "KHR_draco_mesh_compression": "Draco",
    "EXT_meshopt_compression": "meshopt",
    "KHR_meshopt_compression": "meshopt",
}


class Additions:
    """Bytes to append to a document's buffers, put together once at the end."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._pieces: dict[int, list[bytes]] = {}
        self._ends: dict[int, int] = {}

    def put(self, view: dict[str, Any], content: bytes, buffer: int) -> None:
        """Append bytes to a buffer, and let a buffer view show them."""
        pieces = self._pieces.setdefault(buffer, [])
        end = self._ends.get(buffer, len(self._document.buffers[buffer]))
        padding = bytes(-end % ALIGNMENT)
        pieces += [padding, content]
        view.update(buffer=buffer, byteOffset=end + len(padding), byteLength=len(content))
        self._ends[buffer] = end + len(padding) + len(content)

    def finish(self) -> None:
        """Write all bytes, and drop placeholder buffers at the end that no view shows."""
        document = self._document
        for buffer, pieces in self._pieces.items():
            document.buffers[buffer] = b"".join([document.buffers[buffer], *pieces])
            document.json["buffers"][buffer]["byteLength"] = len(document.buffers[buffer])
        shown = {view.get("buffer") for view in document.items("bufferViews")}
        while self._pieces and len(document.buffers) > 1 and not document.buffers[-1]:
            if len(document.buffers) - 1 in shown:
                break
            document.buffers.pop()
            document.json["buffers"].pop()


def forget_extension(document: Document, name: str) -> None:
    """Take an extension off a document's lists, and say that it is saved without."""
    for key in ("extensionsUsed", "extensionsRequired"):
        names = document.json.get(key)
        if isinstance(names, list):
            names[:] = [other for other in names if other != name]
            if not names:
                del document.json[key]
    document.warnings.append(
        f"the file is compressed by {PLAIN_NAMES[name]} ({name}); cutcell saves it uncompressed"
    )
