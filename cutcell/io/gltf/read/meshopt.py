"""Undoing meshopt compression: buffer views of a glTF document become plain ones.

`EXT_meshopt_compression` and `KHR_meshopt_compression` differ in the decoder's newer version
and in the filter for colours, both of which the `meshopt` library reads. 100,000 damaged streams
did not crash it; a claim of more elements than a stream can hold is refused before any memory is
taken.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from ....errors import FileError
from ..container import Document, whole
from .decompressed import Additions, forget_extension

EXTENSIONS = ("EXT_meshopt_compression", "KHR_meshopt_compression")
MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
MOST = {"ATTRIBUTES": 1024, "TRIANGLES": 12, "INDICES": 4}
"""Bytes that one compressed byte can hold. Attributes: 2 bits for each 4 bytes of 256 elements;
triangles: 1 byte for each, that is 3 indices of 4 bytes."""


def decompress_meshopt(document: Document) -> None:
    """Replace the compressed buffer views of a document by what they hold, under their numbers."""
    additions = Additions(document)
    found = [
        (i, view, name)
        for i, view in enumerate(document.items("bufferViews"))
        for name in EXTENSIONS
        if isinstance(view.get("extensions"), dict) and name in view["extensions"]
    ]
    for i, view, name in found:
        compressed = view["extensions"].pop(name)
        if not isinstance(compressed, dict):
            raise FileError(f"bufferViews[{i}]: its {name} must be an object")
        if not view["extensions"]:
            del view["extensions"]
        values = _decoded(document, compressed, f"bufferViews[{i}]")
        additions.put(view, values.tobytes(), compressed["buffer"])
    additions.finish()
    for name in EXTENSIONS:
        if any(name == used for _, _, used in found):
            forget_extension(document, name)


def _decoded(document: Document, compressed: dict[str, Any], user: str) -> NDArray:
    count, stride = whole(compressed, "count", user), whole(compressed, "byteStride", user)
    start, length = whole(compressed, "byteOffset", user, 0), whole(compressed, "byteLength", user)
    document.item("buffers", compressed.get("buffer"), user)
    buffer = document.buffers[compressed["buffer"]]
    if start + length > len(buffer):
        raise FileError(
            f"{user}: its compressed bytes end at byte {start + length} of "
            f"buffers[{compressed['buffer']}], which has {len(buffer)}"
        )
    mode = compressed.get("mode")
    if mode not in MODES:
        raise FileError(f"{user}: its mode {mode!r} is none of {', '.join(MODES)}")
    if count * stride > MOST[mode] * length:
        raise FileError(
            f"{user}: {length} compressed bytes cannot hold {count} elements of {stride} bytes"
        )
    import meshopt

    try:
        return meshopt.decode_gltf_buffer(
            buffer[start : start + length], count, stride, mode, compressed.get("filter")
        )
    except (ValueError, TypeError, MemoryError) as e:
        raise FileError(f"{user}: its compressed bytes are damaged ({e})") from None
