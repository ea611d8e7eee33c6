"""Standard output, whose errors differ from those of other files."""

from __future__ import annotations

import codecs
import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from .display import json_escape

ESCAPED = "cutcell_escaped"
"""Name of the error handler that writes what an encoding lacks as JSON's escapes."""


class OutputError(Exception):
    """Standard output cannot be written to.

    Parameters
    ----------
    cause : OSError
    """

    def __init__(self, cause: OSError) -> None:
        super().__init__(cause.strerror or str(cause))
        self.reader_is_gone = cause.errno == errno.EPIPE


class _Output(io.TextIOWrapper):
    def write(self, text: str) -> int:
        with output_errors():
            return super().write(text)

    def flush(self) -> None:
        with output_errors():
            super().flush()


@contextmanager
def checked_output() -> Iterator[None]:
    """Raise `OutputError` in this block, or at its end, where standard output is full or closed.

    Characters that its encoding lacks are escaped.
    """
    before, output = sys.stdout, _open()
    sys.stdout = output
    try:
        try:
            yield
        finally:
            output.flush()
    except OutputError:
        with open(os.devnull, "wb") as nothing:  # for what is left in the buffers
            os.dup2(nothing.fileno(), output.fileno())
        raise
    finally:
        sys.stdout = before
        output.detach()


def _open() -> _Output:
    before = sys.stdout
    if before is None:  # closed: a file that can only be read takes its number, and fails likewise
        closed = os.fdopen(os.open(os.devnull, os.O_RDONLY), "wb")
        return _Output(closed, "utf-8")
    by_line = bool(before.line_buffering)
    return _Output(before.buffer, before.encoding, ESCAPED, line_buffering=by_line)


@contextmanager
def output_errors() -> Iterator[None]:
    """Raise `OutputError` in this block where standard output cannot be written to."""
    try:
        yield
    except OSError as error:
        raise OutputError(error) from None


def _escape(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    return json_escape(error.object[error.start : error.end]), error.end


codecs.register_error(ESCAPED, _escape)
