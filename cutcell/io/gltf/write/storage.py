"""Where the bytes of a glTF document lie when it is written again.

Nothing is overwritten in place. What is stored gets buffer views of its own, and `Storage.finish`
puts one new buffer together: the bytes of every buffer view that is still needed are copied once,
and what was stored is appended. Views that only dropped accessors use are left out.

The numbers of accessors and buffer views never change, so that everything else that refers
to them stays right, extensions too.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from itertools import chain
from math import inf
from typing import Any

import pygltflib
from numpy.typing import NDArray

from ....errors import FileError
from ..read.accessors import COMPONENTS
from ..references import accessors_in, places_in, views_in

ALIGNMENT = 8
KINDS = {
    1: pygltflib.SCALAR,
    2: pygltflib.VEC2,
    3: pygltflib.VEC3,
    4: pygltflib.VEC4,
    16: pygltflib.MAT4,
}
CODES = {dtype: code for code, dtype in COMPONENTS.items()}


class Storage:
    """The accessors, buffer views and bytes of a document that is being edited.

    Parameters
    ----------
    document : dict
        The JSON, to be edited.
    buffers : list of bytes
    dropped : iterable of int
        Accessors that are given up. Those that the document still refers to are left alone.
    """

    def __init__(
        self, document: dict[str, Any], buffers: list[bytes], dropped: Iterable[int]
    ) -> None:
        self.document = document
        self.accessors: list[dict[str, Any]] = document.setdefault("accessors", [])
        self.views: list[dict[str, Any]] = document.setdefault("bufferViews", [])
        self._buffers = buffers
        rest = {k: v for k, v in document.items() if k not in ("accessors", "bufferViews")}
        known = {i for i in dropped if type(i) is int and 0 <= i < len(self.accessors)}
        self._free_accessors = known - set(accessors_in(rest))
        kept = [a for i, a in enumerate(self.accessors) if i not in self._free_accessors]
        freed = [self.accessors[i] for i in self._free_accessors]
        self._dead = frozenset(views_in(freed)) - frozenset(views_in([rest, kept]))
        self._free_views = set(self._dead)
        live = [view for i, view in enumerate(self.views) if i not in self._dead]
        self._places = list(places_in([rest, kept, live]))
        self._arrays: dict[Any, tuple[int, bytearray]] = {}
        self._added: list[tuple[int, bytearray]] = []

    def stored_type(self, accessor: int | None) -> Any:
        """Return the component type of an accessor, if there is one."""
        return None if accessor is None else COMPONENTS[self.accessors[accessor]["componentType"]]

    def store(self, values: NDArray, preferred: int | None, of_mesh: bool = True) -> int:
        """Store an array and return its accessor.

        Arrays of one type share a buffer view if those that they replace shared one.

        Shapes: values (n, k).
        """
        index = preferred
        if index is None or index not in self._free_accessors:
            index = _new(self.accessors)
        self._free_accessors.discard(index)
        accessor = self.accessors[index]
        view, content = self._array_view(accessor.get("bufferView"), values, of_mesh)
        for key in ("normalized", "sparse", "min", "max"):
            accessor.pop(key, None)
        accessor.update(
            bufferView=view,
            byteOffset=len(content),
            componentType=CODES[values.dtype],
            count=len(values),
            type=KINDS[values.shape[1]],
        )
        content += values.tobytes()
        return index

    def _array_view(self, old: int | None, values: NDArray, of_mesh: bool) -> tuple[int, bytearray]:
        """Return the buffer view that an array goes to, and the content of that so far."""
        key = old if old in self._dead else None, values.dtype, values.shape[1], of_mesh
        if key not in self._arrays:
            free = self._free_views & {old} or self._free_views
            view = min(free) if free else _new(self.views)
            self._free_views.discard(view)
            # An extension of the old view told of the old bytes, such as how they were compressed.
            own = {k: v for k, v in self.views[view].items() if k in ("name", "extras")}
            use: dict[str, int] = {}
            if of_mesh and values.shape[1] == 1 and values.dtype.kind == "u":
                use = {"target": pygltflib.ELEMENT_ARRAY_BUFFER}
            elif of_mesh:
                stride = values.shape[1] * values.itemsize
                use = {"byteStride": stride, "target": pygltflib.ARRAY_BUFFER}
            self.views[view] = {**own, **use}
            self._arrays[key] = view, bytearray()
        return self._arrays[key]

    def add_view(self, content: bytes) -> int:
        """Store bytes and return their buffer view."""
        self._added.append((_new(self.views), bytearray(content)))
        return self._added[-1][0]

    def finish(self) -> bytes:
        """Return the one buffer; the document then refers to it, and to no other.

        What is left over of dropped accessors and their views stays as empty shells, unless
        it stands at the end of its list.
        """
        data = self._repack()
        # Arrays stand last, as they will when this document is loaded and written again.
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
        """Copy all bytes that are still needed, and let the document find them there."""
        data = bytearray()
        copied = []
        for buffer, start, end in _merged(map(self._span, self._places)):
            data += bytes((start - len(data)) % ALIGNMENT)  # what was aligned stays so
            copied.append((buffer, start, len(data)))
            data += self._buffers[buffer][start:end]
        for place in self._places:
            buffer, old = place["buffer"], place.get("byteOffset", 0)
            _, start, now = copied[bisect_right(copied, (buffer, old, inf)) - 1]
            place["buffer"] = 0
            if now - start:
                place["byteOffset"] = old + now - start
        return data

    def _span(self, place: dict[str, Any]) -> tuple[int, int, int]:
        """Return the buffer of a place, and where its bytes start and end there."""
        buffer, start = place["buffer"], place.get("byteOffset", 0)
        end = start + place["byteLength"]
        length = len(self._buffers[buffer]) if 0 <= buffer < len(self._buffers) else 0
        if not 0 <= start <= end <= length:
            raise FileError(
                f"its document refers to the bytes {start} to {end} of buffers[{buffer}], which "
                f"has {length}; the file is damaged"
            )
        return buffer, start, end


def _merged(spans: Iterable[tuple[int, int, int]]) -> list[tuple[int, int, int]]:
    """Return spans in ascending order, those that touch or overlap as one."""
    found: list[tuple[int, int, int]] = []
    for buffer, start, end in sorted(spans):
        if found and found[-1][0] == buffer and start <= found[-1][2]:
            found[-1] = (buffer, found[-1][1], max(found[-1][2], end))
        else:
            found.append((buffer, start, end))
    return found


def _new(objects: list[dict[str, Any]]) -> int:
    objects.append({})
    return len(objects) - 1


def _drop_last(objects: list[dict[str, Any]], free: set[int]) -> None:
    while objects and len(objects) - 1 in free:
        objects.pop()
        free.discard(len(objects))
