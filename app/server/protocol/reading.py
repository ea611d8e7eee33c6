"""Reading of messages: each part has the declared type, or the message is refused."""

from __future__ import annotations

import math
from dataclasses import fields
from functools import cache
from types import UnionType
from typing import Any, get_args, get_origin, get_type_hints, is_typeddict

import numpy as np

from cutcell.errors import CutcellError
from cutcell.runtime.display import printable

from .received import RECEIVED, Message

MAX_SHOWN = 60
REFUSALS = (TypeError, ValueError, OverflowError)


class MessageError(CutcellError):
    """A message of the browser is not one that the page sends."""


def read(data: dict[str, Any]) -> Message:
    """Return the message that the browser sent.

    Raises
    ------
    MessageError
        Its type is unknown, or it lacks a part, or a part has another type.
    """
    kind: Any = RECEIVED.get(str(data.get("type")))
    if kind is None:
        raise _error(f"its type must be one that the page knows, not {_shown(data.get('type'))}")
    parts = {}
    for name, (hint, is_needed) in _hints(kind).items():
        if name in data:
            try:
                parts[name] = _converted(data[name], hint)
            except REFUSALS:
                raise _error(f"{kind.type}.{name} cannot be {_shown(data[name])}") from None
        elif is_needed:
            raise _error(f"{kind.type} has no {name}")
    message: Message = kind(**parts)
    return message


def _error(problem: str) -> MessageError:
    return MessageError(f"the browser sent a malformed message: {problem}; reload the page")


def _shown(value: Any) -> str:
    return printable(repr(value), MAX_SHOWN)


@cache
def _hints(kind: Any) -> dict[str, tuple[Any, bool]]:
    """Return the type of each part, and whether a message must have it."""
    hints = get_type_hints(kind)
    # Both defaults are MISSING where a part must be there.
    return {one.name: (hints[one.name], one.default is one.default_factory) for one in fields(kind)}


def _converted(value: Any, hint: Any) -> Any:
    """Return a value as one of a type; raise TypeError or ValueError where it is of none."""
    parts = get_args(hint)
    if hint is Any:
        return value
    if isinstance(hint, UnionType):
        return _first(value, parts)
    if is_typeddict(hint) and isinstance(value, dict):
        return {
            name: _converted(value.get(name), part) for name, part in get_type_hints(hint).items()
        }
    if get_origin(hint) is list:
        return [_converted(one, parts[0]) for one in _sequence(value)]
    if get_origin(hint) is tuple:
        return tuple(_converted(*one) for one in zip(_sequence(value), parts, strict=True))
    if hint is bytes and isinstance(value, bytes | bytearray | memoryview):
        return value
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if hint is float and is_number and math.isfinite(value):
        return float(value)
    if hint is int and is_number and value == int(value):
        return int(value)
    if hint in (str, bool, type(None)) and isinstance(value, hint):
        return value
    raise TypeError


def _first(value: Any, hints: tuple[Any, ...]) -> Any:
    for hint in hints:
        try:
            return _converted(value, hint)
        except REFUSALS:
            continue
    raise TypeError


def _sequence(value: Any) -> list[Any] | tuple[Any, ...]:
    if isinstance(value, np.ndarray):
        return value.tolist()  # type: ignore[no-any-return]
    if isinstance(value, list | tuple):
        return value
    raise TypeError
