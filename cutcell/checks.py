"""Checks of parameters at the public doors."""

import math
from collections.abc import Collection
from typing import Any

from .errors import ParameterError


def check_integer(name: str, value: Any, low: int, high: int, why: str = "") -> int:
    """Return `value` as an int, or say which range it must lie in.

    Raises
    ------
    ParameterError
        Not a whole number, or outside `low` to `high`.
    """
    if isinstance(value, bool) or not _is_whole(value) or not low <= value <= high:
        reason = f"; {why}" if why else ""
        raise ParameterError(
            f"{name} must be a whole number from {low} to {high:,}, not {value!r}{reason}"
        )
    return int(value)


def check_number(name: str, value: Any, low: float, high: float, why: str = "") -> float:
    """Return `value` as a float, or say which range it must lie in.

    Raises
    ------
    ParameterError
        Not a finite number, or outside `low` to `high`.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not low <= number <= high:  # also catches nan
        reason = f"; {why}" if why else ""
        raise ParameterError(
            f"{name} must be a number from {low:g} to {high:g}, not {value!r}{reason}"
        )
    return number


def check_choice(name: str, value: Any, choices: Collection[Any]) -> Any:
    """Return `value` if it is one of `choices`, or list them.

    Raises
    ------
    ParameterError
        Not one of them.
    """
    if value not in choices:
        listed = ", ".join(repr(c) for c in choices)
        raise ParameterError(f"{name} must be one of {listed}, not {value!r}")
    return value


def _is_whole(value: Any) -> bool:
    try:
        return int(value) == value
    except (TypeError, ValueError, OverflowError):
        return False
