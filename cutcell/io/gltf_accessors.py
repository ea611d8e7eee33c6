"""Decoding glTF accessors: strides, normalised integers, sparse values."""

from __future__ import annotations

from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

from ..errors import FileError
from .gltf_container import Document, whole

COMPONENTS: dict[int, np.dtype] = {
    pygltflib.BYTE: np.dtype("<i1"),
    pygltflib.UNSIGNED_BYTE: np.dtype("<u1"),
    pygltflib.SHORT: np.dtype("<i2"),
    pygltflib.UNSIGNED_SHORT: np.dtype("<u2"),
    pygltflib.UNSIGNED_INT: np.dtype("<u4"),
    pygltflib.FLOAT: np.dtype("<f4"),
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
MOST_ZEROS = 10_000_000
"""Longest accessor without data of its own: a file of a few bytes can ask for any."""


def read_accessor(document: Document, index: Any, kind: str, user: str) -> NDArray:
    """Return an accessor's values.

    Parameters
    ----------
    document : Document
    index : int
        The accessor.
    kind : str
        The type it must have, such as "VEC3".
    user : str
        Who refers to it, for the error.

    Returns
    -------
    array, shape (count, width)
        float64 for floats and normalised integers, else the stored integer type.
    """
    accessor = document.item("accessors", index, user)
    if accessor.get("type") != kind:
        raise FileError(f"{user}: accessors[{index}] is {accessor.get('type')}, expected {kind}")
    if index not in document.decoded:
        document.decoded[index] = _decode(document, accessor, f"accessors[{index}]")
    return document.decoded[index]


def _decode(document: Document, accessor: dict[str, Any], user: str) -> NDArray:
    width = WIDTHS[accessor["type"]]
    dtype = component(accessor, user)
    count = whole(accessor, "count", user)
    if count < 1:
        raise FileError(f"{user} is empty: its count is 0")
    if "bufferView" in accessor:
        values = _viewed(document, accessor, count, width, dtype, user)
    elif count > MOST_ZEROS:
        raise FileError(f"{user} asks for {count} elements and has no data")
    else:
        values = np.zeros((count, width), dtype)
    if "sparse" in accessor:
        values = _with_sparse(document, accessor["sparse"], values, user)
    return _normalised(values, accessor)


def component(owner: dict[str, Any], user: str) -> np.dtype:
    """Return the numpy type of "componentType"."""
    code = owner.get("componentType")
    if type(code) is not int or code not in COMPONENTS:
        raise FileError(f"{user}: componentType {code!r} is none of glTF's")
    return COMPONENTS[code]


def _viewed(
    document: Document, owner: dict[str, Any], count: int, width: int, dtype: np.dtype, user: str
) -> NDArray:
    """Return `count` elements that `owner` finds in its buffer view."""
    view = document.item("bufferViews", owner["bufferView"], user)
    name = f"bufferViews[{owner['bufferView']}]"
    document.item("buffers", view.get("buffer"), name)
    buffer = document.buffers[view["buffer"]]
    start, length = whole(view, "byteOffset", name, 0), whole(view, "byteLength", name)
    if start + length > len(buffer):
        raise FileError(
            f"{name} ends at byte {start + length} of buffers[{view['buffer']}], "
            f"which has {len(buffer)}"
        )
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
    if stride == element:
        flat = np.frombuffer(buffer, dtype, count * width, start + offset)
        return flat.reshape(count, width)
    return np.ndarray((count, width), dtype, buffer, start + offset, (stride, dtype.itemsize))


def _with_sparse(document: Document, sparse: Any, values: NDArray, user: str) -> NDArray:
    user = f"{user}, sparse"
    if not isinstance(sparse, dict):
        raise FileError(f"{user}: must be an object")
    where, what = sparse.get("indices"), sparse.get("values")
    if not isinstance(where, dict) or not isinstance(what, dict):
        raise FileError(f'{user}: needs "indices" and "values"')
    for part in (where, what):
        if "bufferView" not in part:
            raise FileError(f'{user}: "indices" and "values" need a "bufferView"')
    count = whole(sparse, "count", user)
    if count == 0:
        return values
    rows = _viewed(document, where, count, 1, component(where, user), user)[:, 0]
    if rows.dtype.kind != "u" or rows.max() >= len(values):
        raise FileError(f"{user}: an index is out of range (0 to {len(values) - 1})")
    values = values.copy()
    values[rows] = _viewed(document, what, count, values.shape[1], values.dtype, user)
    return values


def _normalised(values: NDArray, accessor: dict[str, Any]) -> NDArray:
    if values.dtype.kind == "f":
        return values.astype(np.float64)
    if accessor.get("normalized") is True:
        largest = np.iinfo(values.dtype).max
        return np.maximum(values.astype(np.float64) / largest, -1.0)
    return values
