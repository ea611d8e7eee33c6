"""Checks of arrays that people give."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import one_line
from ..errors import CutcellError

MAX_COORDINATE = 1e60
"""Largest coordinate to compute with: products of a few of them must not overflow."""
NUMBER_KINDS = "biufO"
"""Kinds of arrays that may hold numbers: not complex ones, texts or dates."""
MAX_EXACT_INTEGER = 2**53
"""Whole numbers up to this are themselves as float64."""


def check_positions(points: NDArray[np.float64], what: str, error: type[CutcellError]) -> None:
    """Refuse points whose coordinates are too large to compute with. Shapes: points (n, 3)."""
    far = np.flatnonzero((np.abs(points) > MAX_COORDINATE).any(axis=1))
    if len(far):
        position = ", ".join(f"{x:.3g}" for x in points[far[0]])
        raise error(
            f"{what} {far[0]} lies at ({position}), too far out to compute with "
            f"(the limit is {MAX_COORDINATE:g}; {len(far)} of {len(points)} are so); move or "
            "delete it, or scale the whole character down"
        )


def as_array(
    value: Any, dtype: Any, shape: tuple[int | None, ...], name: str, error: type[Exception]
) -> NDArray:
    """Return what is given as an array: a copy, unless nobody can write to what is given."""
    try:
        array = np.asarray(value)
        empty = [0 if size is None else size for size in shape]
        if array.size == 0 and 0 in empty:  # whatever its own shape and type
            array = np.zeros(empty)
        if array.dtype.kind not in NUMBER_KINDS:
            raise error(f"{name} must be an array of real numbers, not of {array.dtype}")
        if np.issubdtype(dtype, np.integer) and array.dtype.kind == "f":
            with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
                array = array.astype(np.float64)  # half precision knows no such number
            array = np.where(np.abs(array) <= MAX_EXACT_INTEGER, array, 0.5)
            if not np.array_equal(array, np.round(array)):
                raise error(f"{name} must be whole numbers")
        if dtype is np.bool_ and not ((array == 0) | (array == 1)).all():
            raise error(f"{name} must be True or False each")
        flags = array.flags
        if flags.writeable or not (array.dtype == dtype and flags.c_contiguous and flags.aligned):
            with np.errstate(invalid="ignore"):
                array = np.array(array, dtype=dtype)
    except (TypeError, ValueError, OverflowError) as e:
        if isinstance(e, error):
            raise
        raise error(f"{name} must be an array of numbers: {one_line(e)}") from None
    expected = tuple("any" if s is None else s for s in shape)
    if array.ndim != len(shape) or any(
        s is not None and s != a for s, a in zip(shape, array.shape, strict=True)
    ):
        raise error(f"{name} has the shape {array.shape}, expected {expected}".replace("'", ""))
    return array


def frozen(array: NDArray) -> NDArray:
    """Return an array after making it read-only."""
    array.flags.writeable = False
    return array


def check_finite(points: NDArray, what: str, error: type, names: Any = None) -> None:
    """Refuse points (n, 3) with a coordinate that is not a finite number."""
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        which = f'"{names[bad[0]]}"' if names else str(bad[0])
        raise error(
            f"{what} {which} has a coordinate that is not a finite number "
            f"({points[bad[0]].tolist()}); {len(bad)} of {len(points)} are so"
        )
