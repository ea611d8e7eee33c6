"""Undoing Draco compression: the primitives of a glTF document get plain accessors.

Draco's decoder runs in a process of its own, with a limit of time and memory: of 3,000 damaged
meshes of 18 kB none crashed it, but some kept it busy for 20 seconds.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

from ....errors import FileError
from ....isolated.run import WorkFailedError, run_isolated
from ..container import Document, whole
from .accessors import WIDTHS, component
from .decompressed import Additions, forget_extension
from .primitives import attributes, primitives

EXTENSION = "KHR_draco_mesh_compression"
SECONDS_A_MEGABYTE, MIN_SECONDS = 10.0, 10.0
MEMORY_A_BYTE, MIN_MEMORY = 500, 2**29
"""What the decoder may take: a byte holds up to some 20 vertices of a regular grid."""


def decompress_draco(document: Document) -> None:
    """Replace compressed primitives by plain ones; the numbers of accessors stay."""
    found = _compressed(document)
    packed = [(user, primitive, own) for user, primitive, own in found if not _plain(document, own)]
    views = list(dict.fromkeys(own["bufferView"] for _, _, own in packed))
    decoded = _decode(document, views) if views else {}
    additions = Additions(document)
    done: dict[int, tuple[int, Any]] = {}
    for user, primitive, own in packed:
        _Unpacking(document, additions, done, decoded, views.index(own["bufferView"])).into(
            primitive, own, user
        )
    additions.finish()
    if found:
        forget_extension(document, EXTENSION)


def _compressed(document: Document) -> list[tuple[str, dict[str, Any], dict[str, Any]]]:
    """Take the extension off all primitives; return their labels, themselves and what it said."""
    found = []
    for m, mesh in enumerate(document.items("meshes")):
        if "primitives" not in mesh:
            continue
        for k, primitive in enumerate(primitives(document, m, f"meshes[{m}]")):
            extensions = primitive.get("extensions")
            if not isinstance(extensions, dict) or EXTENSION not in extensions:
                continue
            user = f"{document.label('meshes', m)}, primitive {k}"
            own = extensions.pop(EXTENSION)
            if not extensions:
                del primitive["extensions"]
            if not isinstance(own, dict) or not isinstance(own.get("attributes"), dict):
                raise FileError(f"{user}: its {EXTENSION} must name attributes and a bufferView")
            own["plain"] = [primitive.get("indices"), *attributes(primitive, user).values()]
            found.append((user, primitive, own))
    return found


def _plain(document: Document, own: dict[str, Any]) -> bool:
    """Tell whether a primitive is also stored plainly, for readers without a decoder."""
    accessors = document.items("accessors")
    found = [accessors[i] for i in own["plain"] if type(i) is int and 0 <= i < len(accessors)]
    return len(found) == len(own["plain"]) and all("bufferView" in a for a in found)


def _decode(document: Document, views: list[int]) -> dict[str, NDArray]:
    pieces = [_bytes(document, view) for view in views]
    data = b"".join(pieces)
    job = {"data": np.frombuffer(data, np.uint8), "ends": np.cumsum([len(p) for p in pieces])}
    seconds = MIN_SECONDS + SECONDS_A_MEGABYTE * len(data) / 2**20
    memory = MIN_MEMORY + MEMORY_A_BYTE * len(data)
    try:
        return run_isolated("draco", job, seconds, "the Draco decoder", memory)
    except WorkFailedError as e:
        raise FileError(f"its Draco compression cannot be undone: {e}") from None


def _bytes(document: Document, view: Any) -> bytes:
    found = document.item("bufferViews", view, EXTENSION)
    name = f"bufferViews[{view}]"
    document.item("buffers", found.get("buffer"), name)
    start, length = whole(found, "byteOffset", name, 0), whole(found, "byteLength", name)
    data = document.buffers[found["buffer"]][start : start + length]
    if len(data) < length or not length:
        raise FileError(f"{name} is cut short: {length} bytes announced, {len(data)} there")
    return data


class _Unpacking:
    """Writes one decoded mesh into the accessors of the primitives that show it."""

    def __init__(
        self,
        document: Document,
        additions: Additions,
        done: dict[int, tuple[int, Any]],
        decoded: dict[str, NDArray],
        mesh: int,
    ) -> None:
        self.document, self.additions, self.done = document, additions, done
        self.decoded, self.mesh = decoded, mesh

    def into(self, primitive: dict[str, Any], own: dict[str, Any], user: str) -> None:
        """Fill a primitive's accessors; it draws plain triangles afterwards."""
        faces = self.decoded[f"faces_{self.mesh}"].reshape(-1, 1)
        self.view: int | None = own["bufferView"]
        self.buffer = self.document.json["bufferViews"][own["bufferView"]]["buffer"]
        primitive["indices"] = self._fill(primitive.get("indices"), faces, "indices", user)
        primitive["mode"] = pygltflib.TRIANGLES
        count = None
        for name, unique in own["attributes"].items():
            values = self.decoded.get(f"values_{self.mesh}_{unique}")
            if values is None or name not in primitive["attributes"]:
                raise FileError(f"{user}: {name} is not in its Draco data")
            if count not in (None, len(values)):
                raise FileError(f"{user}: its attributes hold {count} and {len(values)} vertices")
            count = len(values)
            primitive["attributes"][name] = self._fill(
                primitive["attributes"][name], values.reshape(count, -1), name, user
            )

    def _fill(self, index: Any, values: NDArray, name: str, user: str) -> int:
        """Let an accessor show values; another one if it shows another mesh's already."""
        accessors = self.document.items("accessors")
        accessor = self.document.item("accessors", index, f"{user}, {name}")
        key = (self.mesh, name)
        if index in self.done:
            if self.done[index] == key:
                return index
            accessors.append(accessor := dict(accessor))
            index = len(accessors) - 1
        self.done[index] = key
        values = _typed(values, accessor, f"{user}, {name}")
        for key_ in ("sparse", "byteOffset"):
            accessor.pop(key_, None)
        accessor.update(bufferView=self._show(values, name), count=len(values))
        if "min" in accessor or "max" in accessor:
            accessor["min"] = values.min(axis=0).tolist()
            accessor["max"] = values.max(axis=0).tolist()
        return index

    def _show(self, values: NDArray, name: str) -> int:
        """Store values in a buffer view of their own; the compressed one is used again."""
        views = self.document.items("bufferViews")
        rows = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), -1)
        view: dict[str, Any] = {"target": pygltflib.ELEMENT_ARRAY_BUFFER}
        if name != "indices":
            rows = np.pad(rows, ((0, 0), (0, -rows.shape[1] % 4)))
            view = {"byteStride": rows.shape[1], "target": pygltflib.ARRAY_BUFFER}
        self.additions.put(view, rows.tobytes(), self.buffer)
        if self.view is not None and self.view not in self._taken():
            at, self.view = self.view, None
            views[at].clear()
            views[at].update(view)
            return at
        views.append(view)
        return len(views) - 1

    def _taken(self) -> set[Any]:
        return {a.get("bufferView") for a in self.document.items("accessors")}


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
            accessor["componentType"], dtype = pygltflib.UNSIGNED_INT, np.dtype("<u4")
    return values.astype(dtype)
