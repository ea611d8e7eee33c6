"""Cache of the last result of each costly step."""

from collections.abc import Callable
from typing import Any


class Memo:
    """Keeps the last result of each costly step while its inputs are the same."""

    def __init__(self) -> None:
        self._cached: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def __call__(self, name: str, inputs: tuple[Any, ...], make: Callable[[], Any]) -> Any:
        """Return the result of `make`, which is called only if the inputs differ from the last.

        Numbers and texts are compared by value, all else by identity.
        """
        cached = self._cached.get(name)
        if cached is None or not _same_inputs(cached[0], inputs):
            cached = self._cached[name] = (inputs, make())
        return cached[1]


def _same_inputs(a: tuple[Any, ...], b: tuple[Any, ...]) -> bool:
    return len(a) == len(b) and all(
        x is y or (isinstance(x, int | float | str) and type(x) is type(y) and x == y)
        for x, y in zip(a, b, strict=True)
    )
