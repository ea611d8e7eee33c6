"""Decoding glTF accessors: strides, normalised integers, sparse values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError
from ..constants import COMPONENTS, WIDTHS
from ..container import Document, whole

BYTES_PER_NUMBER = 8
"""Decoded; every accessor counts with them, since many can show the same bytes."""


@dataclass(frozen=True, eq=False)
class Stored:
    """Elements of one type among the bytes of a buffer, not copied; zeros without any bytes."""

    count: int
    width: int
    dtype: np.dtype
    buffer: bytes | None = field(repr=False)
    start: int = 0
    stride: int = 0

    def array(self) -> NDArray:
        """Return them as they are stored, shape (count, width)."""
        shape = self.count, self.width
        if self.buffer is None:
            return np.broadcast_to(np.zeros((), self.dtype), shape)
        strides = self.stride, self.dtype.itemsize
        return np.ndarray(shape, self.dtype, self.buffer, self.start, strides)


@dataclass(frozen=True, eq=False)
class Accessor:
    """The checked elements of an accessor, to be decoded when they are wanted."""

    base: Stored
    normalized: bool = False
    rows: Stored | None = None  # elements that a sparse accessor replaces, and by what
    replaced: Stored | None = None

    def __len__(self) -> int:
        return self.base.count

    def stored(self) -> NDArray:
        """Return all elements in the stored type, shape (count, width)."""
        values = self.base.array()
        if self.rows is not None and self.replaced is not None:
            values = values.copy()
            values[self.rows.array()[:, 0]] = self.replaced.array()
        return values

    def decoded(self, at: NDArray[np.intp] | slice = slice(None)) -> NDArray:
        """Return some elements (k, width): integers as they are stored, all else as float64."""
        values = self.stored()[at]
        if self.base.dtype.kind == "f":
            with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
                return values.astype(np.float64)
        if self.normalized:
            return np.maximum(values.astype(np.float64) / np.iinfo(self.base.dtype).max, -1.0)
        return values


def read_accessor(document: Document, index: Any, kind: str, user: str) -> NDArray:
    """Return an accessor's values. Returns shapes (count, width)."""
    accessor = find_accessor(document, index, kind, user)
    if index not in document.decoded:
        document.decoded[index] = accessor.decoded()
    return document.decoded[index]


def find_accessor(document: Document, index: Any, kind: str, user: str) -> Accessor:
    """Return an accessor, checked and not decoded; see `read_accessor`."""
    accessor = document.item("accessors", index, user)
    if accessor.get("type") != kind:
        raise FileError(f"{user}: accessors[{index}] is {accessor.get('type')}, expected {kind}")
    if index not in document.accessors:
        document.accessors[index] = _checked(document, accessor, f"accessors[{index}]")
    return document.accessors[index]


def _checked(document: Document, accessor: dict[str, Any], user: str) -> Accessor:
    width = WIDTHS[accessor["type"]]
    dtype = component(accessor, user)
    count = whole(accessor, "count", user)
    if count < 1:
        raise FileError(f"{user} is empty: its count is 0")
    base = Stored(count, width, dtype, None)
    if "bufferView" in accessor:
        base = _viewed(document, accessor, count, width, dtype, user)
    document.allowance.take(count * width * BYTES_PER_NUMBER, user)
    normalized = accessor.get("normalized") is True and dtype.kind != "f"
    if "sparse" not in accessor:
        return Accessor(base, normalized)
    return Accessor(base, normalized, *_sparse(document, accessor["sparse"], base, user))


def component(owner: dict[str, Any], user: str) -> np.dtype:
    """Return the numpy type of "componentType"."""
    code = owner.get("componentType")
    if type(code) is not int or code not in COMPONENTS:
        raise FileError(f"{user}: componentType {code!r} is none of glTF's")
    return COMPONENTS[code]


def _viewed(
    document: Document, owner: dict[str, Any], count: int, width: int, dtype: np.dtype, user: str
) -> Stored:
    """Return `count` elements that `owner` finds in its buffer view."""
    view = document.item("bufferViews", owner["bufferView"], user)
    name = f"bufferViews[{owner['bufferView']}]"
    buffer, start, length = document.view_range(view, name)
    offset = whole(owner, "byteOffset", user, 0)
    element = width * dtype.itemsize
    stride = whole(view, "byteStride", name, 0) or element
    if stride < element:
        raise FileError(f"{name}: a stride of {stride} bytes is too short for {user}")
    if offset + stride * (count - 1) + element > length:
        raise FileError(
            f"{user} runs past {name}: {count} elements from byte {offset} need "
            f"{offset + stride * (count - 1) + element} bytes, {length} are there"
        )
    return Stored(count, width, dtype, buffer, start + offset, stride)


def _sparse(document: Document, sparse: Any, base: Stored, user: str) -> tuple[Stored, ...]:
    """Return the numbers and the values of the elements that a sparse accessor replaces."""
    user = f"{user}, sparse"
    if not isinstance(sparse, dict):
        raise FileError(f"{user}: must be an object")
    where, what = sparse.get("indices"), sparse.get("values")
    if not isinstance(where, dict) or not isinstance(what, dict):
        raise FileError(f'{user}: needs "indices" and "values"')
    if "bufferView" not in where or "bufferView" not in what:
        raise FileError(f'{user}: "indices" and "values" need a "bufferView"')
    count = whole(sparse, "count", user)
    if count == 0:
        return ()
    rows = _viewed(document, where, count, 1, component(where, user), user)
    if rows.dtype.kind != "u" or rows.array().max() >= base.count:
        raise FileError(f"{user}: an index is out of range (0 to {base.count - 1})")
    return rows, _viewed(document, what, count, base.width, base.dtype, user)
