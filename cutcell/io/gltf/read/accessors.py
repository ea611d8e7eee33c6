"""Decoding glTF accessors: strides, normalised integers, sparse values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError
from ..constants import COMPONENTS, WIDTHS
from ..container import Document, whole

BYTES_PER_NUMBER = 8
"""Decoded; every accessor counts with them, since many can show the same bytes."""


@dataclass(frozen=True, eq=False)
class Accessor:
    """The checked elements of an accessor, to be decoded when they are wanted."""

    stored: NDArray  # (count, width): in their type, a view of the buffer unless some are replaced
    normalized: bool = False

    def __len__(self) -> int:
        return len(self.stored)

    @cached_property
    def is_finite(self) -> bool:
        """Whether all numbers are finite."""
        return self.stored.dtype.kind != "f" or bool(np.isfinite(self.stored).all())

    @cached_property
    def values(self) -> NDArray:
        """All elements, decoded once."""
        return self.decoded()

    def decoded(self, at: NDArray[np.intp] | slice = slice(None)) -> NDArray:
        """Return some elements (k, width): integers as they are stored, all else as float64."""
        values = self.stored[at]
        if values.dtype.kind == "f":
            with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
                return values.astype(np.float64)
        if self.normalized:
            return np.maximum(values.astype(np.float64) / np.iinfo(values.dtype).max, -1.0)
        return values


def read_accessor(document: Document, index: Any, kind: str, user: str) -> NDArray:
    """Return an accessor's values. Returns shapes (count, width)."""
    return find_accessor(document, index, kind, user).values


def find_accessor(document: Document, index: Any, kind: str, user: str) -> Accessor:
    """Return an accessor, checked and not decoded; see `read_accessor`."""
    accessor = document.item("accessors", index, user)
    if accessor.get("type") != kind:
        raise FileError(f"{user}: accessors[{index}] is {accessor.get('type')}, expected {kind}")
    if index not in document.accessors:
        document.accessors[index] = _checked(document, accessor, f"accessors[{index}]")
    return document.accessors[index]


def _checked(document: Document, accessor: dict[str, Any], user: str) -> Accessor:
    width, dtype = WIDTHS[accessor["type"]], component(accessor, user)
    count = whole(accessor, "count", user)
    if count < 1:
        raise FileError(f"{user} is empty: its count is 0")
    stored = np.broadcast_to(np.zeros((), dtype), (count, width))
    if "bufferView" in accessor:
        stored = _viewed(document, accessor, count, width, dtype, user)
    document.allowance.take(count * width * BYTES_PER_NUMBER, user)
    if "sparse" in accessor:
        stored = _sparse(document, accessor["sparse"], stored, f"{user}, sparse")
    return Accessor(stored, accessor.get("normalized") is True and dtype.kind != "f")


def component(owner: dict[str, Any], user: str) -> np.dtype:
    """Return the numpy type of "componentType"."""
    code = owner.get("componentType")
    if type(code) is not int or code not in COMPONENTS:
        raise FileError(f"{user}: componentType {code!r} is none of glTF's")
    return COMPONENTS[code]


def _viewed(
    document: Document, owner: dict[str, Any], count: int, width: int, dtype: np.dtype, user: str
) -> NDArray:
    """Return `count` elements that `owner` has in its buffer view, not copied."""
    view = document.item("bufferViews", owner["bufferView"], user)
    name = f"bufferViews[{owner['bufferView']}]"
    buffer, start, length = document.view_range(view, name)
    offset = whole(owner, "byteOffset", user, 0)
    element = width * dtype.itemsize
    stride = whole(view, "byteStride", name, 0) or element
    if stride < element:
        raise FileError(f"{name}: a stride of {stride} bytes is too short for {user}")
    needed = offset + stride * (count - 1) + element
    if needed > length:
        raise FileError(
            f"{user} runs past {name}: {count} elements from byte {offset} need {needed} bytes, "
            f"{length} are there"
        )
    return np.ndarray((count, width), dtype, buffer, start + offset, (stride, dtype.itemsize))


def _sparse(document: Document, sparse: Any, base: NDArray, user: str) -> NDArray:
    """Return elements of which a sparse accessor replaces some."""
    if not isinstance(sparse, dict):
        raise FileError(f"{user}: must be an object")
    where: Any = sparse.get("indices")
    what: Any = sparse.get("values")
    for owner in (where, what):
        if not isinstance(owner, dict) or "bufferView" not in owner:
            raise FileError(f'{user}: "indices" and "values" need a "bufferView"')
    count = whole(sparse, "count", user)
    if count == 0:
        return base
    rows = _viewed(document, where, count, 1, component(where, user), user)[:, 0]
    if rows.dtype.kind != "u" or rows.max() >= len(base):
        raise FileError(f"{user}: an index is out of range (0 to {len(base) - 1})")
    values = base.copy()
    values[rows] = _viewed(document, what, count, base.shape[1], base.dtype, user)
    return values
