"""Checks of parameters at the public doors."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from .errors import ParameterError, SkeletonError

if TYPE_CHECKING:
    from .rig import Skeleton


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


def check_has_joints(skeleton: Skeleton) -> None:
    """Refuse the skeleton of a mesh that came without one, and say how to give it one.

    Raises
    ------
    SkeletonError
        It has no joints.
    """
    if len(skeleton.joints) == 0:
        raise SkeletonError(
            "the rig has no skeleton; export the mesh together with its armature, or save it as "
            "OBJ or PLY and put a skeleton beside it in a JSON file of the same name, for example "
            '{"joints": [{"name": "root", "position": [0, 0, 0], "parent": null}, '
            '{"name": "tip", "position": [0, 1, 0], "parent": "root"}]}'
        )


def _is_whole(value: Any) -> bool:
    try:
        return int(value) == value
    except (TypeError, ValueError, OverflowError):
        return False
