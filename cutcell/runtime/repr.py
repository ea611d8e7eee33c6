"""Short representations of objects with large arrays, as notebooks and debuggers show them."""

import html
import reprlib
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from .display import shown_name

MAX_ITEMS = 3


def short_repr(value: Any) -> str:
    """Represent arrays by type and shape, and long collections by their length."""
    if isinstance(value, np.ndarray):
        return f"{value.dtype}{list(value.shape)}"
    if is_dataclass(value) and type(value).__repr__ is not short_repr:
        return f"<{type(value).__name__}>"
    if is_dataclass(value):
        values = (f"{f.name}={short_repr(getattr(value, f.name))}" for f in fields(value) if f.repr)
        return f"{type(value).__name__}({', '.join(values)})"
    if isinstance(value, bytes | tuple | list | dict | set) and len(value) > MAX_ITEMS:
        return f"<{type(value).__name__} of {len(value)}>"
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(short_repr, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key!r}: {short_repr(item)}" for key, item in value.items()) + "}"
    return repr(value)


class Summarized:
    """Objects with large arrays, represented by a few counts: a line, and a table in notebooks."""

    @property
    def _summary(self) -> dict[str, Any]:
        """What the object is represented by, at most ten values by their names."""
        raise NotImplementedError

    def __repr__(self) -> str:
        values = (f"{name}={reprlib.repr(value)}" for name, value in self._summary.items())
        return f"{type(self).__name__}({', '.join(values)})"

    def _repr_html_(self) -> str:
        """Return the values as a table."""
        rows = (
            f"<tr><th>{name.replace('_', ' ')}</th><td>{html.escape(_cell(value))}</td></tr>"
            for name, value in self._summary.items()
        )
        return f"<table><caption>{type(self).__name__}</caption>{''.join(rows)}</table>"


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,}" if isinstance(value, int | float) else shown_name(str(value))
