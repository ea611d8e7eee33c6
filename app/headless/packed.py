"""Arrays of messages as one block of bytes, each once."""

import hashlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

QUANTISED = frozenset({"scalars", "weights", "distances"})
"""Arrays of these names have 16 bits a number, which is more than colours and cards show."""
STEPS = 65535
ALIGNED = 4


class Packed:
    """The block `content`, in which arrays begin at multiples of four bytes, and its messages."""

    def __init__(self) -> None:
        self.content = bytearray()
        self._places: dict[tuple[str, bytes], int] = {}

    def plain(self, value: Any, name: str = "") -> Any:
        """Return a message as JSON values.

        An array becomes {"$": [type, first byte, length, unit]}; its numbers are multiples of the
        unit.
        """
        if isinstance(value, np.ndarray):
            return {"$": self._put(value.ravel(), name in QUANTISED)}
        if isinstance(value, dict):
            return {key: self.plain(one, key) for key, one in value.items()}
        if isinstance(value, list | tuple):
            return [self.plain(one) for one in value]
        return value.item() if isinstance(value, np.generic) else value

    def _put(self, array: NDArray[Any], quantised: bool) -> list[Any]:
        unit = 1.0
        if quantised and array.dtype.kind == "f" and len(array) and array.min() >= 0:
            unit = float(array.max()) / STEPS or 1 / STEPS  # 1 is of numbers as they are
            array = np.rint(array / unit).astype(np.uint16)
        elif array.dtype.itemsize == 8:
            array = array.astype(np.float32 if array.dtype.kind == "f" else np.int32)
        kind, data = f"{array.dtype.kind}{array.dtype.itemsize}", array.tobytes()
        key = kind, hashlib.sha1(data, usedforsecurity=False).digest()
        if key not in self._places:
            self._places[key] = len(self.content)
            self.content += data + bytes(-len(data) % ALIGNED)
        return [kind, self._places[key], len(array), unit]
