"""Decompression of glTF documents: meshopt's buffer views and Draco's primitives become plain.

`EXT_meshopt_compression` and `KHR_meshopt_compression` differ in the decoder's newer version
and in the filter for colours, both of which the `meshopt` library reads. 100,000 damaged streams
did not crash it; a claim of more elements than a stream can hold is refused before any memory is
allocated. Draco's decoder runs in a subprocess with a limit of time and memory: of 3,000 damaged
meshes of 18 kB none crashed it, but a few kept it busy for 20 seconds.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError, MissingLibraryError
from ....isolated.run import WorkFailedError, run_isolated
from ..buffer import BufferWriter
from ..constants import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, ROUNDED, TRIANGLES, WIDTHS
from ..container import Document, extensions, read_document, whole
from .accessors import component
from .primitives import primitives

MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
MAX_BYTES_PER_BYTE = {"ATTRIBUTES": 1024, "TRIANGLES": 12, "INDICES": 4}
"""Bytes that one compressed byte can hold. Attributes: 2 bits for each 4 bytes of 256 elements;
triangles: 1 byte for each, that is 3 indices of 4 bytes."""
DRACO = "KHR_draco_mesh_compression"
DRACO_SECONDS_A_MEGABYTE, MIN_SECONDS = 10.0, 60.0
DRACO_MEMORY_A_BYTE, DRACO_MIN_MEMORY = 500, 2**29
"""Limits of Draco's decoder: a byte holds up to some 20 vertices of a regular grid."""


def plain_document(path: Path) -> Document:
    """Read a document and decompress its accessors."""
    document = read_document(path)
    decompress_meshopt(document)
    decompress_draco(document)
    document.allow()  # what was compressed is larger now
    return document


def decompress_meshopt(document: Document) -> None:
    """Replace the compressed buffer views of a document by plain ones with the same numbers."""
    contents: dict[int, bytes] = {}
    for name in MESHOPT:
        used = [i for i, v in enumerate(document.items("bufferViews")) if name in extensions(v)]
        for i in used:
            view, user = document.items("bufferViews")[i], f"bufferViews[{i}]"
            contents[i] = _decoded(document, _take(view, name, user), user).tobytes()
            for key in ("buffer", "byteOffset", "byteLength"):
                view.pop(key, None)
        if used:
            _forget_extension(document, name, "meshopt")
    if not contents:
        return
    for buffer in document.items("buffers"):  # placeholders say so in an extension
        for name in extensions(buffer).keys() & set(MESHOPT):
            _take(buffer, name, "a buffer")
    writer = BufferWriter(document.json, document.buffers)
    for i, content in contents.items():
        writer.add_view(content, i)
    document.buffers = [writer.finish()]


def _take(owner: dict[str, Any], name: str, user: str) -> dict[str, Any]:
    """Remove an extension from an object and return it."""
    extension = owner["extensions"].pop(name)
    if not owner["extensions"]:
        del owner["extensions"]
    if not isinstance(extension, dict):
        raise FileError(f"{user}: its {name} must be an object")
    return extension


def _forget_extension(document: Document, name: str, label: str) -> None:
    """Remove an extension from a document's lists, and warn that it is saved without."""
    for key in ("extensionsUsed", "extensionsRequired"):
        names = document.json.get(key)
        if isinstance(names, list):
            names[:] = [other for other in names if other != name]
            if not names:
                del document.json[key]
    document.warnings.append(
        f"the file is compressed by {label} ({name}); cutcell saves it uncompressed"
    )


def _decoded(document: Document, compressed: dict[str, Any], user: str) -> NDArray:
    count, stride = whole(compressed, "count", user), whole(compressed, "byteStride", user)
    buffer, start, length = document.view_range(compressed, f"{user} (compressed)")
    mode = compressed.get("mode")
    if mode not in MODES:
        raise FileError(f"{user}: its mode {mode!r} is none of {', '.join(MODES)}")
    if count * stride > MAX_BYTES_PER_BYTE[mode] * length:
        raise FileError(
            f"{user}: {length} compressed bytes cannot hold {count} elements of {stride} bytes"
        )
    try:
        import meshopt
    except ImportError:
        raise MissingLibraryError(
            "the file is compressed by meshopt, whose decoder is not installed; try: pip install "
            "meshopt (it needs a C++ compiler where there is no wheel), or save the file "
            "without compression"
        ) from None
    try:
        return meshopt.decode_gltf_buffer(
            buffer[start : start + length], count, stride, mode, compressed.get("filter")
        )
    except (ValueError, TypeError, MemoryError) as e:
        raise FileError(f"{user}: its compressed bytes are damaged ({e})") from None


def decompress_draco(document: Document) -> None:
    """Replace compressed primitives by plain ones; the numbers of accessors stay."""
    compressed = _compressed(document)
    packed = [one for one in compressed if not _plain(document, one[2])]
    views = list(dict.fromkeys(extension["bufferView"] for _, _, extension in packed))
    if packed:
        unpacking = _Unpacking(document, views, _decode(document, views))
        for user, primitive, extension in packed:
            unpacking.fill_primitive(primitive, extension, user)
        document.buffers = [unpacking.writer.finish()]
    if compressed:
        _forget_extension(document, DRACO, "Draco")


def _compressed(document: Document) -> list[tuple[str, dict[str, Any], dict[str, Any]]]:
    """Take the extension off all primitives; return their labels, themselves and what it said."""
    compressed = []
    for m, mesh in enumerate(document.items("meshes")):
        drawn = primitives(document, m, f"meshes[{m}]") if "primitives" in mesh else ()
        for one in drawn:
            if DRACO not in extensions(one.json):
                continue
            extension = _take(one.json, DRACO, one.label)
            if not isinstance(extension.get("attributes"), dict):
                raise FileError(f"{one.label}: its {DRACO} must name attributes and a bufferView")
            extension["plain"] = [one.json.get("indices"), *one.attributes.values()]
            compressed.append((one.label, one.json, extension))
    return compressed


def _plain(document: Document, extension: dict[str, Any]) -> bool:
    """Return whether a primitive is also stored plainly, for readers without a decoder."""
    accessors = document.items("accessors")
    used = [accessors[i] for i in extension["plain"] if type(i) is int and 0 <= i < len(accessors)]
    return len(used) == len(extension["plain"]) and all("bufferView" in a for a in used)


def _decode(document: Document, views: list[int]) -> dict[str, NDArray]:
    pieces = []
    for view in views:
        owner = document.item("bufferViews", view, DRACO)
        buffer, start, length = document.view_range(owner, f"bufferViews[{view}]")
        pieces.append(buffer[start : start + length])
    data = b"".join(pieces)
    job = {"data": np.frombuffer(data, np.uint8), "ends": np.cumsum([len(p) for p in pieces])}
    seconds = MIN_SECONDS + DRACO_SECONDS_A_MEGABYTE * len(data) / 2**20
    memory = DRACO_MIN_MEMORY + DRACO_MEMORY_A_BYTE * len(data)
    task, who = "cutcell.isolated.draco:decode", "the Draco decoder"
    try:
        return run_isolated(task, job, seconds, who, memory, extra="DracoPy")
    except WorkFailedError as e:
        raise FileError(f"its Draco compression cannot be undone: {e}") from None


class _Unpacking:
    """Writes decoded meshes into the accessors of the primitives that use them."""

    def __init__(self, document: Document, views: list[int], decoded: dict[str, NDArray]) -> None:
        self.document, self.views, self.decoded = document, views, decoded
        self.writer = BufferWriter(document.json, document.buffers, (), views)
        self.filled: dict[int, tuple[int, str]] = {}  # by accessor, its mesh and attribute

    def fill_primitive(self, primitive: dict[str, Any], draco: dict[str, Any], user: str) -> None:
        """Fill a primitive's accessors; it draws plain triangles afterwards."""
        mesh, named = self.views.index(draco["bufferView"]), primitive["attributes"]
        faces = self.decoded[f"faces_{mesh}"].reshape(-1, 1)
        primitive["indices"] = self._fill(primitive.get("indices"), faces, (mesh, "indices"), user)
        primitive["mode"] = TRIANGLES
        count = None
        for name, unique in draco["attributes"].items():
            values = self.decoded.get(f"values_{mesh}_{unique}")
            if values is None or name not in named:
                raise FileError(f"{user}: {name} is not in its Draco data")
            if count not in (None, len(values)):
                raise FileError(f"{user}: its attributes hold {count} and {len(values)} vertices")
            count = len(values)
            named[name] = self._fill(named[name], values.reshape(count, -1), (mesh, name), user)

    def _fill(self, index: Any, values: NDArray, key: tuple[int, str], user: str) -> int:
        """Fill an accessor; a copy of it if another mesh has filled it."""
        name = f"{user}, {key[1]}"
        accessor = self.document.item("accessors", index, name)
        if index in self.filled:
            if self.filled[index] == key:
                return index
            self.writer.accessors.append(accessor := dict(accessor))
            index = len(self.writer.accessors) - 1
        self.filled[index] = key
        if key[1] == "POSITION":
            accessor.setdefault("extras", {ROUNDED: True})
        values = _typed(values, accessor, name)
        target = ELEMENT_ARRAY_BUFFER if key[1] == "indices" else ARRAY_BUFFER
        self.writer.append(accessor, values, target)
        if "min" in accessor or "max" in accessor:
            accessor.update(min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())
        return index


def _typed(values: NDArray, accessor: dict[str, Any], user: str) -> NDArray:
    """Return decoded values in the type that their accessor announces."""
    dtype = component(accessor, user)
    if len(values) == 0 or WIDTHS.get(accessor.get("type", "")) != values.shape[1]:
        raise FileError(
            f"{user}: is announced as {accessor.get('type')}, its Draco data has "
            f"{len(values)} x {values.shape[1]} numbers"
        )
    if dtype.kind != "f":
        most = np.iinfo(dtype)
        if values.min() < most.min or values.max() > most.max:
            if not user.endswith("indices"):
                raise FileError(f"{user}: its Draco data does not fit into {dtype.name}")
            accessor["componentType"], dtype = 5125, np.dtype("<u4")
    return values.astype(dtype)
