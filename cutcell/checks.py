"""Checks of single values that people give."""

from __future__ import annotations

import math
from collections.abc import Collection
from numbers import Real
from typing import Any

from .errors import ParameterError

MAX_SHOWN = 60
"""Characters of a wrong value that are shown, at most."""


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


def one_line(text: object) -> str:
    """Write what may be several lines, a library's error for example, on one."""
    return " ".join(str(text).split())


def shown(value: Any) -> str:
    """Write a wrong value on one line, and not all of it if it is long."""
    try:
        text = one_line(repr(value))
    except Exception:  # a number of thousands of digits has no text, others may be broken
        return f"something of the type {type(value).__name__}"
    return text if len(text) <= MAX_SHOWN else f"{text[: MAX_SHOWN - 3]}..."


def _is_real(value: Any) -> bool:
    """Return whether this is one real number, of Python or numpy; truth values are none."""
    return isinstance(value, Real) and not isinstance(value, bool) and value == value


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:  # an integer of hundreds of digits
        return math.inf if value > 0 else -math.inf


def assign(target: Any, **values: Any) -> None:
    """Set fields of a frozen dataclass, as its `__post_init__` does with checked values."""
    for name, value in values.items():
        object.__setattr__(target, name, value)


def check_kind(where: str, value: Any, kind: type) -> None:
    """Refuse a value of another type."""
    if not isinstance(value, kind):
        raise ParameterError(f"{where} must be a {kind.__name__}, not {shown(value)}")
