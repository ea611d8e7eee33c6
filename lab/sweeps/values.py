"""Values of options as text, as people type them."""

from __future__ import annotations

from typing import Any

from cutcell.errors import ParameterError

WORDS = {"all": None, "none": None, "yes": True, "no": False, "true": True, "false": False}


def parsed_values(text: str) -> list[Any]:
    """Return values that are separated by commas: numbers, "yes", "no", "all", or names.

    Whether an option accepts a value is not checked.

    Raises
    ------
    ParameterError
        There is no value.
    """
    values = [_value(part.strip()) for part in text.split(",") if part.strip()]
    if not values:
        raise ParameterError("values must be separated by commas, such as 32,64,128")
    return values


def _value(text: str) -> Any:
    if text.lower() in WORDS:
        return WORDS[text.lower()]
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
