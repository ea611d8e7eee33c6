"""glTF documents that are made or edited, and their buffer.

Nothing is overwritten in place. New arrays get new buffer views, and `BufferWriter.finish`
assembles one new buffer: the bytes of every buffer view that is still needed are copied once,
and the new arrays follow. Views that only dropped accessors use are left out.

The numbers of accessors and buffer views never change, so that everything else that refers
to them stays right, extensions too.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from itertools import chain
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError
from .constants import ARRAY_BUFFER, COMPONENTS, ELEMENT_ARRAY_BUFFER

ALIGNMENT = 8
ACCESSOR_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
ACCESSOR_KEYS = ("indices", "inverseBindMatrices", "input", "output")
CODES = {dtype: code for code, dtype in COMPONENTS.items()}


class BufferWriter:
    """The accessors, buffer views and bytes of a document whose JSON is made or edited.

    `dropped` accessors and views are given up, except those that it still refers to.
    """

    def __init__(
        self,
        document: dict[str, Any],
        buffers: Sequence[bytes] = (),
        dropped: Iterable[int] = (),
        dropped_views: Iterable[int] = (),
    ) -> None:
        self.document = document
        self.accessors: list[dict[str, Any]] = document.setdefault("accessors", [])
        self.views: list[dict[str, Any]] = document.setdefault("bufferViews", [])
        self._buffers = buffers
        rest = {k: v for k, v in document.items() if k not in ("accessors", "bufferViews")}
        valid = {i for i in dropped if type(i) is int and 0 <= i < len(self.accessors)}
        self._free_accessors = valid - set(accessors_in(rest))
        live = [a for i, a in enumerate(self.accessors) if i not in self._free_accessors]
        freed = [self.accessors[i] for i in self._free_accessors]
        self._dead = {*views_in(freed), *dropped_views} - set(views_in([rest, live]))
        self._free_views = set(self._dead)
        live += [view for i, view in enumerate(self.views) if i not in self._dead]
        self._ranges = list(ranges_in([rest, live]))
        self._arrays: dict[Any, tuple[int, bytearray]] = {}
        self._added: list[tuple[int, bytearray]] = []

    def store(
        self,
        values: NDArray,
        preferred: int | None = None,
        target: int | None = ARRAY_BUFFER,
        bounds: bool = False,
        normalized: bool = False,
    ) -> int:
        """Store an array (n, k) and return its accessor: `preferred` if it was dropped."""
        index = preferred if preferred in self._free_accessors else _new(self.accessors)
        self._free_accessors.discard(index)
        accessor = self.accessors[index]
        for key in ("normalized", "min", "max"):
            accessor.pop(key, None)
        self.append(accessor, values, target)
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor.update(min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())
        return index

    def append(self, accessor: dict[str, Any], values: NDArray, target: int | None) -> None:
        """Append an array (n, k) to the buffer and let an accessor refer to it.

        Arrays of one type share a buffer view if those that they replace shared one.
        """
        rows = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), -1)
        if target == ARRAY_BUFFER:  # whose elements start on multiples of 4 bytes
            rows = np.pad(rows, ((0, 0), (0, -rows.shape[1] % 4)))
        view, content = self._array_view(accessor.get("bufferView"), values, rows.shape[1], target)
        accessor.pop("sparse", None)
        accessor.update(
            bufferView=view,
            byteOffset=len(content),
            componentType=CODES[values.dtype],
            count=len(values),
            type=ACCESSOR_TYPES[values.shape[1]],
        )
        content += rows.tobytes()

    def _array_view(
        self, old: int | None, values: NDArray, stride: int, target: int | None
    ) -> tuple[int, bytearray]:
        """Return the buffer view for an array, and its content so far."""
        key = old if old in self._dead else None, values.dtype, values.shape[1], target
        if key not in self._arrays:
            free = self._free_views & {old} or self._free_views
            view = min(free) if free else _new(self.views)
            self._free_views.discard(view)
            # An extension of the old view described the old bytes, such as their compression.
            used = {k: v for k, v in self.views[view].items() if k in ("name", "extras")}
            if target == ARRAY_BUFFER:
                used["byteStride"] = stride
            self.views[view] = used if target is None else {**used, "target": target}
            self._arrays[key] = view, bytearray()
        return self._arrays[key]

    def add_view(self, content: bytes, view: int | None = None) -> int:
        """Store bytes and return their buffer view, a new one or one that names no buffer yet."""
        self._added.append((_new(self.views) if view is None else view, bytearray(content)))
        return self._added[-1][0]

    def finish(self) -> bytes:
        """Return the one buffer of the document; what was dropped leaves empty shells."""
        data = self._repack()
        # Arrays come last, as they do when this document is loaded and written again.
        for view, content in chain(self._added, self._arrays.values()):
            data += bytes(-len(data) % ALIGNMENT)
            self.views[view].update(buffer=0, byteOffset=len(data), byteLength=len(content))
            data += content
        data += bytes(-len(data) % 4)
        for i in self._free_accessors:
            for key in ("bufferView", "byteOffset", "sparse", "min", "max"):
                self.accessors[i].pop(key, None)
        for i in self._free_views:
            self.views[i] = {"buffer": 0, "byteLength": 1}
        _drop_last(self.accessors, self._free_accessors)
        _drop_last(self.views, self._free_views)
        self.document["buffers"] = self.document.get("buffers", [])[:1] or [{}]
        self.document["buffers"][0]["byteLength"] = len(data)
        return bytes(data)

    def _repack(self) -> bytearray:
        """Copy all bytes that are still needed, and let the document refer to the copies."""
        data = bytearray()
        copied = []
        for buffer, start, end in _merged(map(self._span, self._ranges)):
            data += bytes((start - len(data)) % ALIGNMENT)  # what was aligned stays so
            copied.append((buffer, start, len(data)))
            data += self._buffers[buffer][start:end]
        for owner in self._ranges:
            buffer, old = owner["buffer"], owner.get("byteOffset", 0)
            _, start, now = copied[bisect_right(copied, (buffer, old, inf)) - 1]
            owner["buffer"] = 0
            if now - start:
                owner["byteOffset"] = old + now - start
        return data

    def _span(self, owner: dict[str, Any]) -> tuple[int, int, int]:
        """Return a buffer, and the first and last byte that an object uses of it."""
        buffer, start = owner["buffer"], owner.get("byteOffset", 0)
        end = start + owner["byteLength"]
        length = len(self._buffers[buffer]) if 0 <= buffer < len(self._buffers) else 0
        if not 0 <= start <= end <= length:
            raise FileError(
                f"its document refers to the bytes {start} to {end} of buffers[{buffer}], which "
                f"has {length}; the file is damaged"
            )
        return buffer, start, end


def _merged(spans: Iterable[tuple[int, int, int]]) -> list[tuple[int, int, int]]:
    """Return spans in ascending order, those that touch or overlap as one."""
    merged: list[tuple[int, int, int]] = []
    for buffer, start, end in sorted(spans):
        if merged and merged[-1][0] == buffer and start <= merged[-1][2]:
            merged[-1] = (buffer, merged[-1][1], max(merged[-1][2], end))
        else:
            merged.append((buffer, start, end))
    return merged


def _new(objects: list[dict[str, Any]]) -> int:
    objects.append({})
    return len(objects) - 1


def _drop_last(objects: list[dict[str, Any]], free: set[int]) -> None:
    while objects and len(objects) - 1 in free:
        objects.pop()
        free.discard(len(objects))


# References. Unknown extensions are searched too: names as in the specification are references.


def accessors_in(value: Any) -> Iterator[int]:
    """Yield the numbers of the accessors that a part of a document refers to."""
    for owner in _objects_in(value):
        named = [owner.get(key) for key in ACCESSOR_KEYS]
        targets = owner.get("targets")
        targets = targets if isinstance(targets, list) else []
        for attributes in (owner.get("attributes"), *targets):
            named += attributes.values() if isinstance(attributes, dict) else ()
        yield from (number for number in named if type(number) is int)


def views_in(value: Any) -> Iterator[int]:
    """Yield the numbers of the buffer views that a part of a document refers to."""
    for owner in _objects_in(value):
        if type(owner.get("bufferView")) is int:
            yield owner["bufferView"]


def ranges_in(value: Any) -> Iterator[dict[str, Any]]:
    """Yield the objects that name bytes of a buffer, as views do; extras are an application's."""
    for owner in _objects_in(value, but="extras"):
        if type(owner.get("buffer")) is int and type(owner.get("byteLength")) is int:
            yield owner


def _objects_in(value: Any, but: str | None = None) -> Iterator[dict[str, Any]]:
    """Yield every object inside a JSON value, except below one key."""
    stack = [value]
    while stack:
        value = stack.pop()
        if isinstance(value, dict):
            yield value
            stack.extend(child for key, child in value.items() if key != but)
        elif isinstance(value, list):
            stack.extend(value)


# The default material of glTF is metal, which looks black without surroundings.
PLAIN_MATERIAL = {
    "name": "plain",
    "doubleSided": True,
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.8, 0.8, 0.8, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.8,
    },
}


class GltfBuilder:
    """A document under construction, with one plain material."""

    def __init__(self, generator: str) -> None:
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "materials": [deepcopy(PLAIN_MATERIAL)],
            "nodes": [],
            "meshes": [],
        }
        self.buffer = BufferWriter(self.json)

    def add(self, kind: str, item: dict[str, Any]) -> int:
        """Append an object to a top-level list and return its number."""
        self.json.setdefault(kind, []).append(item)
        return len(self.json[kind]) - 1

    def add_node(self, node: dict[str, Any], parent: int | None = None) -> int:
        """Append a node, perhaps below another one, and return its number."""
        number = self.add("nodes", node)
        if parent is not None:
            self.json["nodes"][parent].setdefault("children", []).append(number)
        return number

    def add_mesh(self, name: str, attributes: dict[str, int], faces: NDArray) -> int:
        """Append a mesh with one primitive. Shapes: faces (m, 3)."""
        count = self.buffer.accessors[attributes["POSITION"]]["count"]
        kind = "<u2" if count <= np.iinfo(np.uint16).max else "<u4"
        indices = self.buffer.store(faces.reshape(-1, 1).astype(kind), target=ELEMENT_ARRAY_BUFFER)
        primitive = {"attributes": attributes, "indices": indices, "material": 0}
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def add_skin(self, joints: list[int], inverse: NDArray, **fields: Any) -> int:
        """Append a skin. Shapes: inverse (j, 4, 4)."""
        binds = self.floats(inverse.transpose(0, 2, 1).reshape(-1, 16), target=None)
        return self.add("skins", {"joints": joints, "inverseBindMatrices": binds, **fields})

    def add_track(
        self, animation: dict[str, Any], node: int, path: str, times: int, values: NDArray
    ) -> None:
        """Append the motion of a node (k, 3 or 4) to an animation; `times` is an accessor."""
        sampler = {"input": times, "output": self.floats(values, target=None)}
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]), "target": target})
        animation["samplers"].append(sampler)

    def floats(
        self, values: NDArray, target: int | None = ARRAY_BUFFER, bounds: bool = False
    ) -> int:
        """Store an array as 32-bit floats and return its accessor."""
        with np.errstate(over="ignore"):  # readers refuse what becomes infinite
            return self.buffer.store(values.astype("<f4"), None, target, bounds)
