"""Where the bytes of a glTF document lie: freeing, reusing and adding accessors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

from .gltf_accessors import COMPONENTS, WIDTHS

ALIGNMENT = 8
ACCESSOR_KEYS = ("indices", "inverseBindMatrices", "input", "output")
CODES = {dtype: code for code, dtype in COMPONENTS.items()}


class Storage:
    """The accessors, buffer views and bytes of a document that is being edited.

    All buffers become one. The numbers of accessors and buffer views never change, so
    that everything else that refers to them stays right, extensions too.
    """

    def __init__(self, document: dict[str, Any], buffers: list[bytes]) -> None:
        self.document = document
        self.accessors: list[dict[str, Any]] = document.setdefault("accessors", [])
        self.views: list[dict[str, Any]] = document.setdefault("bufferViews", [])
        self.data = bytearray()
        self._free_accessors: set[int] = set()
        self._free_views: set[int] = set()
        self._dead: list[tuple[int, int]] = []
        starts = [self._append(buffer) for buffer in buffers]
        for view in self.views:
            if starts[view["buffer"]]:
                view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
            view["buffer"] = 0
        kept = document.get("buffers", [])[:1]
        document["buffers"] = kept or [{"byteLength": 0}]

    def free(self, accessors: set[int]) -> None:
        """Give accessors up, and the buffer views that only they used.

        Accessors that the document still refers to are left alone.
        """
        rest = {k: v for k, v in self.document.items() if k not in ("accessors", "bufferViews")}
        known = {i for i in accessors if 0 <= i < len(self.accessors)}
        self._free_accessors = known - set(_accessors_in(rest))
        kept = [a for i, a in enumerate(self.accessors) if i not in self._free_accessors]
        freed = [self.accessors[i] for i in self._free_accessors]
        self._free_views = set(_views_in(freed)) - set(_views_in([kept, rest]))
        self._dead = [_extent(self.views[i]) for i in self._free_views]

    def stored_type(self, accessor: int | None) -> np.dtype | None:
        """Return the component type of an accessor, if there is one."""
        return None if accessor is None else COMPONENTS[self.accessors[accessor]["componentType"]]

    def store(self, values: NDArray, preferred: int | None) -> int:
        """Store a VEC4 array and return its accessor.

        Parameters
        ----------
        values : array, shape (n, 4), uint8, uint16 or float32, little-endian
        preferred : int, optional
            A freed accessor to become this one; its place in the buffer is used again
            where the array fits.
        """
        if preferred in self._free_accessors:
            index: int = preferred  # type: ignore[assignment]
        else:
            index = self._new(self.accessors)
        accessor = self.accessors[index]
        view = accessor.get("bufferView")
        if view not in self._free_views and self._overwrite(index, values):
            self._free_accessors.discard(index)
            return index
        if view not in self._free_views:
            view = self._new(self.views)
            self.views[view].update(buffer=0, byteOffset=0, byteLength=0)
        self._free_accessors.discard(index)
        self._free_views.discard(view)
        self._put(view, values)
        for key in ("byteOffset", "normalized", "sparse", "min", "max"):
            accessor.pop(key, None)
        accessor["bufferView"] = view
        accessor["componentType"] = CODES[values.dtype]
        accessor["count"] = len(values)
        accessor["type"] = pygltflib.VEC4
        return index

    def _overwrite(self, index: int, values: NDArray) -> bool:
        """Put values where a freed accessor's own stand between others', if they fit there."""
        accessor = self.accessors[index]
        same = (CODES[values.dtype], len(values), pygltflib.VEC4)
        if same != tuple(accessor.get(k) for k in ("componentType", "count", "type")):
            return False
        view = accessor.get("bufferView")
        if view is None or "sparse" in accessor or self._overlapped(view):
            return False
        if self._shares_bytes(index):
            return False
        start = self.views[view].get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = self.views[view].get("byteStride") or 4 * values.itemsize
        strides = (stride, values.itemsize)
        np.ndarray(values.shape, values.dtype, self.data, start, strides)[:] = values
        for key in ("normalized", "min", "max"):
            accessor.pop(key, None)
        return True

    def _shares_bytes(self, index: int) -> bool:
        """Tell whether another accessor reads bytes that are this one's too."""
        view = self.accessors[index]["bufferView"]
        stride = self.views[view].get("byteStride", 0)
        start, end, width = self._span(index, stride)
        for i, other in enumerate(self.accessors):
            if i == index or i in self._free_accessors:
                continue
            if view in _views_in(other.get("sparse")):
                return True
            if other.get("bufferView") != view:
                continue
            other_start, other_end, other_width = self._span(i, stride)
            apart = (other_start - start) % stride if stride else 0
            between = width <= apart <= stride - other_width
            if other_start < end and start < other_end and not between:
                return True
        return False

    def _span(self, index: int, stride: int) -> tuple[int, int, int]:
        """Return where an accessor starts and ends in its view, and an element's length."""
        accessor = self.accessors[index]
        width = WIDTHS[accessor["type"]] * COMPONENTS[accessor["componentType"]].itemsize
        start = accessor.get("byteOffset", 0)
        return start, start + (stride or width) * (accessor["count"] - 1) + width, width

    def _overlapped(self, view: int) -> bool:
        """Tell whether another buffer view in use covers bytes of this one."""
        start, end = _extent(self.views[view])
        return any(
            i != view and i not in self._free_views and other_start < end and start < other_end
            for i, (other_start, other_end) in enumerate(map(_extent, self.views))
        )

    def _put(self, index: int, values: NDArray) -> None:
        """Make a view hold just these values, in its old place if they fit."""
        view, content = self.views[index], values.tobytes()
        start, end = _extent(view)
        if start % 4 or end - start < len(content) or self._overlapped(index):
            start = self._append(content)
        else:
            self.data[start : start + len(content)] = content
        view.pop("byteStride", None)
        view["byteOffset"], view["byteLength"] = start, len(content)
        view["target"] = pygltflib.ARRAY_BUFFER

    def add_view(self, content: bytes) -> int:
        """Append bytes and return their buffer view."""
        index = self._new(self.views)
        start = self._append(content)
        self.views[index].update(buffer=0, byteOffset=start, byteLength=len(content))
        return index

    def _append(self, content: bytes) -> int:
        self.data += bytes(-len(self.data) % ALIGNMENT)
        start = len(self.data)
        self.data += content
        return start

    @staticmethod
    def _new(objects: list[dict[str, Any]]) -> int:
        objects.append({})
        return len(objects) - 1

    def compact(self) -> None:
        """Take the bytes that were freed and not used again out of the buffer.

        What is left over of freed accessors and views stays as empty shells, unless it
        stands at the end of its list.
        """
        for i in self._free_accessors:
            for key in ("bufferView", "byteOffset", "sparse", "min", "max"):
                self.accessors[i].pop(key, None)
        for i in self._free_views:
            self.views[i] = {"buffer": 0, "byteLength": 1}
        _drop_last(self.accessors, self._free_accessors)
        _drop_last(self.views, self._free_views)
        live = [_extent(v) for i, v in enumerate(self.views) if i not in self._free_views]
        gaps = [_aligned(gap) for gap in _without(self._dead, live)]
        gaps = [(a, b) for a, b in gaps if b > a]
        for view in self.views:
            start, _ = _extent(view)
            shift = sum(b - a for a, b in gaps if b <= start)
            if shift:
                view["byteOffset"] = start - shift
        for a, b in reversed(gaps):
            del self.data[a:b]
        self._free_accessors, self._free_views, self._dead = set(), set(), []

    def finish(self) -> bytes:
        """Return the one buffer, and write its length into the document."""
        self.data += bytes(-len(self.data) % 4)
        self.document["buffers"][0]["byteLength"] = len(self.data)
        return bytes(self.data)


def _dicts_in(value: Any) -> Iterator[dict[str, Any]]:
    """Yield every object inside a JSON value; unknown extensions are looked into too."""
    stack = [value]
    while stack:
        value = stack.pop()
        if isinstance(value, dict):
            yield value
            stack.extend(value.values())
        elif isinstance(value, list):
            stack.extend(value)


def _accessors_in(value: Any) -> Iterator[int]:
    for owner in _dicts_in(value):
        yield from _numbers(owner.get(k) for k in ACCESSOR_KEYS)
        lists = [owner.get("attributes"), *(owner.get("targets") or ())]
        for found in lists:
            if isinstance(found, dict):
                yield from _numbers(found.values())


def _views_in(value: Any) -> Iterator[int]:
    for owner in _dicts_in(value):
        yield from _numbers([owner.get("bufferView")])


def _numbers(values: Iterable[Any]) -> list[int]:
    return [v for v in values if type(v) is int]


def _extent(view: dict[str, Any]) -> tuple[int, int]:
    start = view.get("byteOffset", 0)
    return start, start + view["byteLength"]


def _aligned(gap: tuple[int, int]) -> tuple[int, int]:
    """Shrink a gap so that taking it out keeps everything behind it aligned."""
    a, b = gap
    return -(-a // ALIGNMENT) * ALIGNMENT, b // ALIGNMENT * ALIGNMENT


def _without(ranges: list[tuple[int, int]], taken: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the parts of ranges that no taken one overlaps, ascending and apart."""
    edges = [(a, 1) for a, _ in ranges] + [(b, -1) for _, b in ranges]
    edges += [(a, -(2**32)) for a, _ in taken] + [(b, 2**32) for _, b in taken]
    found: list[tuple[int, int]] = []
    level, opened = 0, 0
    for at, step in sorted(edges, key=lambda e: e[0]):
        if level > 0 and at > opened:
            if found and found[-1][1] == opened:
                opened = found.pop()[0]
            found.append((opened, at))
        level += step
        opened = at
    return found


def _drop_last(objects: list[dict[str, Any]], free: set[int]) -> None:
    while objects and len(objects) - 1 in free:
        objects.pop()
        free.discard(len(objects))
