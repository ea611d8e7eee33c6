"""Argument checks for public functions."""

from __future__ import annotations

import math
from collections.abc import Collection
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CutcellError, ParameterError

LONG = 60
"""Characters of a wrong value that are shown, at most."""
LARGEST = 1e60
"""Largest coordinate to compute with: products of a few of them must not overflow."""


def check_integer(name: str, value: Any, low: int, high: int, why: str = "") -> int:
    """Return `value` as an int, or raise an error that names its range."""
    if not _is_real(value) or not low <= value <= high or int(value) != value:
        reason = f"; {why}" if why else ""
        raise ParameterError(
            f"{name} must be a whole number from {low} to {high:,}, not {shown(value)}{reason}"
        )
    return int(value)


def check_fraction(name: str, value: Any) -> float:
    """Return `value` as a float between 0 and 1; neither of these is one."""
    if not _is_real(value) or not 0 < _as_float(value) < 1:
        raise ParameterError(f"{name} must be a number between 0 and 1, not {shown(value)}")
    return _as_float(value)


def check_number(name: str, value: Any, low: float, high: float) -> float:
    """Return `value` as a float, or raise an error that names its range."""
    if not _is_real(value) or not low <= _as_float(value) <= high:  # also catches nan
        raise ParameterError(
            f"{name} must be a number from {low:g} to {high:g}, not {shown(value)}"
        )
    return _as_float(value)


def check_flag(name: str, value: Any) -> bool:
    """Return `value` as a bool, or say that it must be one."""
    if type(value).__name__ not in ("bool", "bool_"):  # numpy's is called either way
        raise ParameterError(f"{name} must be True or False, not {shown(value)}")
    return bool(value)


def check_choice(name: str, value: Any, choices: Collection[Any]) -> Any:
    """Return the one of `choices` that `value` is equal to, or list them."""
    if isinstance(value, str) or value is None or _is_real(value):
        for choice in choices:
            if choice == value:
                return choice
    listed = ", ".join(repr(c) for c in choices)
    raise ParameterError(f"{name} must be one of {listed}, not {shown(value)}")


def check_positions(points: NDArray[np.float64], what: str, error: type[CutcellError]) -> None:
    """Refuse points whose coordinates are too large to compute with. Shapes: points (n, 3)."""
    far = np.flatnonzero((np.abs(points) > LARGEST).any(axis=1))
    if len(far):
        position = ", ".join(f"{x:.3g}" for x in points[far[0]])
        raise error(
            f"{what} {far[0]} lies at ({position}), too far out to compute with "
            f"(the limit is {LARGEST:g}; {len(far)} of {len(points)} are so); move or delete it, "
            "or scale the whole character down"
        )


def one_line(text: object) -> str:
    """Write what may be several lines, a library's error for example, on one."""
    return " ".join(str(text).split())


def shown(value: Any) -> str:
    """Write a wrong value on one line, and not all of it if it is long."""
    try:
        text = one_line(repr(value))
    except Exception:  # a number of thousands of digits has no text, others may be broken
        return f"something of the type {type(value).__name__}"
    return text if len(text) <= LONG else f"{text[: LONG - 3]}..."


def _is_real(value: Any) -> bool:
    """Return whether this is one real number, of Python or numpy; truth values are none."""
    return isinstance(value, Real) and not isinstance(value, bool) and value == value


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:  # an integer of hundreds of digits
        return math.inf if value > 0 else -math.inf


NUMBERS = "biufO"
"""Kinds of arrays that may hold numbers: not complex ones, texts or dates."""
EXACT = 2**53
"""Whole numbers up to this are themselves as float64."""


def as_array(
    value: Any, dtype: Any, shape: tuple[int | None, ...], name: str, error: type[Exception]
) -> NDArray:
    """Return what is given as an array: a copy, unless nobody can write to what is given."""
    try:
        array = np.asarray(value)
        empty = [0 if size is None else size for size in shape]
        if array.size == 0 and 0 in empty:  # whatever its own shape and type
            array = np.zeros(empty)
        if array.dtype.kind not in NUMBERS:
            raise error(f"{name} must be an array of real numbers, not of {array.dtype}")
        if np.issubdtype(dtype, np.integer) and array.dtype.kind == "f":
            with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
                array = array.astype(np.float64)  # half precision knows no such number
            array = np.where(np.abs(array) <= EXACT, array, 0.5)
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


def assign(target: Any, **values: Any) -> None:
    """Set fields of a frozen dataclass, as its `__post_init__` does with checked values."""
    for name, value in values.items():
        object.__setattr__(target, name, value)


def check_kind(where: str, value: Any, kind: type) -> None:
    """Refuse a value of another type."""
    if not isinstance(value, kind):
        raise ParameterError(f"{where} must be a {kind.__name__}, not {shown(value)}")


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
