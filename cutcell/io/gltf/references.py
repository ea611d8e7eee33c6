"""Who refers to which accessors, buffer views and bytes of a glTF document.

Unknown extensions are looked into, too: what they name as the specification does stays.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

ACCESSOR_KEYS = ("indices", "inverseBindMatrices", "input", "output")


def accessors_in(value: Any) -> Iterator[int]:
    """Yield the numbers of the accessors that a part of a document refers to."""
    for owner in _objects_in(value):
        named = [owner.get(key) for key in ACCESSOR_KEYS]
        targets = owner.get("targets")
        for found in [owner.get("attributes"), *(targets if isinstance(targets, list) else ())]:
            named += found.values() if isinstance(found, dict) else ()
        yield from (number for number in named if type(number) is int)


def views_in(value: Any) -> Iterator[int]:
    """Yield the numbers of the buffer views that a part of a document refers to."""
    for owner in _objects_in(value):
        if type(owner.get("bufferView")) is int:
            yield owner["bufferView"]


def places_in(value: Any) -> Iterator[dict[str, Any]]:
    """Yield the objects that name bytes of a buffer themselves, as buffer views do.

    Extras are an application's own: numbers in there are not taken for references.
    """
    for owner in _objects_in(value, but="extras"):
        if type(owner.get("buffer")) is int and type(owner.get("byteLength")) is int:
            yield owner


def _objects_in(value: Any, but: str | None = None) -> Iterator[dict[str, Any]]:
    """Yield every object inside a JSON value, except what stands under one key."""
    stack = [value]
    while stack:
        value = stack.pop()
        if isinstance(value, dict):
            yield value
            stack.extend(child for key, child in value.items() if key != but)
        elif isinstance(value, list):
            stack.extend(value)
