"""Arrays and mappings of edits in JSON: read, checked, written."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...checks import shown
from ...errors import ParameterError
from ...rig.checks import frozen

MAX_VERTEX = 2**31 - 2
SHORT = 32
"""Longest array that is written as a list of numbers; longer ones are base64, little-endian."""
SPARSE_ARRAYS = {"data": "f", "indices": "i", "indptr": "i"}
"""Arrays of a sparse matrix, and their kinds."""
TYPES: dict[str, str] = {"i": "<i4", "f": "<f8"}


class ByValue:
    """A dataclass with arrays: two are equal if all their fields are."""

    def __eq__(self, other: object) -> bool:
        if self is other or type(self) is not type(other):
            return self is other
        return all(map(_same, _values(self), _values(other)))

    def __hash__(self) -> int:
        return hash((type(self), *map(np.shape, _values(self))))


def _values(value: Any) -> list[Any]:
    return [getattr(value, one.name) for one in fields(value)]


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, csr_array) and isinstance(b, csr_array):
        return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in SPARSE_ARRAYS)
    if a is None or b is None:
        return a is b
    return np.array_equal(a, b) if isinstance(a, np.ndarray) else a is b or bool(a == b)


@contextmanager
def naming(where: str) -> Iterator[None]:
    """Say in parameter errors which part of the edits they are about."""
    try:
        yield
    except ParameterError as error:
        raise ParameterError(f"{where}: {error}") from None


def packed(array: NDArray[Any]) -> Any:
    """Return integers or floats as JSON: a list of a few, else base64 of int32 or float64."""
    if len(array) <= SHORT:
        return array.tolist()
    return base64.b64encode(array.astype(TYPES[array.dtype.kind]).tobytes()).decode()


def ascending(where: str, value: Any) -> NDArray[np.int32]:
    """Return vertices as sorted int32 without repetition; raise a ParameterError otherwise."""
    vertices = numbers(where, value, "i")
    whole = np.isfinite(vertices) & (vertices == np.floor(vertices))
    if not (whole & (vertices >= 0) & (vertices <= MAX_VERTEX)).all():
        raise ParameterError(f"{where} must be whole numbers from 0 to {MAX_VERTEX:,}")
    result = vertices.astype(np.int32)
    if (np.diff(result) <= 0).any():
        raise ParameterError(f"{where} must ascend, each named once")
    return frozen(result)


def numbers(where: str, value: Any, kind: str) -> NDArray[np.float64]:
    """Return an array of numbers, shape (k,); of a text, what `packed` made of "i" or "f"."""
    if isinstance(value, str):
        try:
            value = np.frombuffer(base64.b64decode(value, validate=True), TYPES[kind])
        except (binascii.Error, ValueError):
            raise ParameterError(f"{where} must be a list of numbers, or base64 of them") from None
    try:
        result = np.asarray(value, np.float64)
    except (TypeError, ValueError):
        result = np.empty((0, 0))
    if result.ndim != 1:
        raise ParameterError(f"{where} must be a list of numbers, not {shown(value)}")
    return result


def packed_rows(rows: csr_array) -> dict[str, Any]:
    """Return a sparse matrix as JSON."""
    return {name: packed(getattr(rows, name)) for name in SPARSE_ARRAYS}


def unpacked_rows(value: Any, columns: int) -> csr_array:
    """Read what `packed_rows` returns."""
    data = with_keys("rows", value, SPARSE_ARRAYS)
    parts = [
        numbers(f"{key} of rows", data.get(key, ()), kind) for key, kind in SPARSE_ARRAYS.items()
    ]
    values, indices, starts = parts[0], parts[1].astype(np.int32), parts[2].astype(np.int32)
    try:
        rows = csr_array((values, indices, starts), shape=(max(len(starts) - 1, 0), columns))
        rows.check_format()
    except ValueError as error:
        raise ParameterError(f"rows are no sparse matrix: {error}") from None
    return rows


def mapping(where: str, value: Any) -> dict[Any, Any]:
    """Return a copy of a mapping."""
    if not isinstance(value, Mapping):
        raise ParameterError(f"{where} must be a mapping of names to values, not {shown(value)}")
    return dict(value)


def with_keys(where: str, value: Any, names: Collection[str]) -> dict[str, Any]:
    """Return a copy of a mapping that has no other keys than some names."""
    entries = mapping(where, value)
    for key in entries:
        if key not in names:
            close = get_close_matches(str(key), names, n=1)
            instead = f'did you mean "{close[0]}"?' if close else f"there is {', '.join(names)}"
            raise ParameterError(f"{where} has no {shown(key)}; {instead}")
    return entries


def joint_names(where: str, value: Any) -> tuple[str, ...]:
    """Return names of joints, each once."""
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise ParameterError(f"{where} must be a list of names, not {shown(value)}")
    for name in value:
        joint_name(where, name)
    return tuple(dict.fromkeys(value))


def joint_name(where: str, name: Any) -> str:
    """Return the name of a joint."""
    if not isinstance(name, str):
        raise ParameterError(f"{where} must hold names of joints, not {shown(name)}")
    return name
