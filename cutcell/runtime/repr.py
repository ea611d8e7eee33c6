"""Short representations of objects with large arrays, as notebooks and debuggers show them."""

import html
import reprlib
from typing import Any

from .display import shown_name


class Summarized:
    """Objects with large arrays, represented by a few counts: a line, and a table in notebooks."""

    @property
    def _summary(self) -> dict[str, Any]:
        """Values in the representation of the object, at most ten by name."""
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
