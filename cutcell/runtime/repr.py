"""Short representations of objects with large arrays, as notebooks and debuggers show them."""

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

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
