"""How much memory a file may take: in proportion to what it holds."""

from __future__ import annotations

from ..errors import FileError

LEAST = 2**28
PER_BYTE = 256
"""Bytes that a file of no size, and each of its bytes, may take while it is read. Weights of a
thousand joints for each vertex take some 200 times as much as what they are stored in."""


class Allowance:
    """The rest of the memory that a file may use.

    A few bytes can ask for any amount: an accessor without data, one mesh that is used in a
    thousand places, a header that announces more than follows.

    Parameters
    ----------
    size : int
        Bytes of the file, with all that belongs to it.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._left: float = LEAST + PER_BYTE * size

    def take_weights(self, vertices: int, joints: int) -> None:
        """Count the bytes of a weight matrix."""
        what = f"weights of {vertices:,} vertices for {joints:,} joints"
        self.take(vertices * joints * 8.0, what)

    def take(self, needed: float, what: str) -> None:
        """Count bytes that are about to be taken."""
        self._left -= needed
        if self._left < 0:
            raise FileError(
                f"{what} would take {_readable(needed)} of memory, and a file of "
                f"{_readable(self._size)} may take {_readable(LEAST + PER_BYTE * self._size)} "
                "in all; it is damaged, or asks for more than it holds"
            )


def _readable(size: float) -> str:
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= factor:
            digits = 0 if size >= 100 * factor else 1
            return f"{size / factor:,.{digits}f} {unit}"
    return f"{size:,.0f} bytes"
