"""A stream with a limit for each entry."""

from __future__ import annotations

import io
from typing import IO

from cutcell.errors import FileError

BUFFER = 2**20


class LimitedStream:
    """A stream that refuses to read more than an entry may take."""

    def __init__(self, stream: IO[bytes], what: str, max_bytes: int) -> None:
        self._stream = io.BufferedReader(stream, BUFFER)  # type: ignore[type-var]
        self._what, self._max = what, max_bytes
        self.bytes_read = 0

    def read(self, size: int) -> bytes:
        """Return the next bytes."""
        self._count(size)
        return self._stream.read(size)

    def readline(self) -> bytes:
        """Return the next line."""
        line = self._stream.readline(self._max - self.bytes_read + 1)
        self._count(len(line))
        return line

    def _count(self, size: int) -> None:
        self.bytes_read += size
        if self.bytes_read > self._max:
            raise FileError(
                f"{self._what} holds an entry of more than {self._max / 1e9:.2g} GB; it is damaged"
            )
