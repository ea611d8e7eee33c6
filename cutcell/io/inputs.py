"""What can be loaded besides files: bytes, open files, and pipes."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO

from ..errors import FileError
from .files import read_bytes
from .formats import BY_SUFFIX

Input = str | os.PathLike[str] | bytes | bytearray | memoryview | BinaryIO
ADDRESS = re.compile(r"[A-Za-z][\w+.-]+:/")
OPENED = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")
STL = 84
"""Bytes of the start of a binary STL, which is what another file is taken for."""


@contextmanager
def as_file(source: Input) -> Iterator[Path]:
    """Yield the path of a file that can be read again, and whose ending says what it holds."""
    name: object = "bytes"
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        exists = os.path.exists(path)  # unlike `Path.exists`, of any name
        if ADDRESS.match(str(path)) and not exists:
            address = re.sub(":/+", "://", str(source), count=1)  # a `Path` has one slash less
            raise FileError(f"{address} is an address, not a file. Download the file first")
        if not (exists and path.is_fifo()) and not str(path).startswith(OPENED):
            yield path
            return
        name, data = path.name, read_bytes(path)
    elif isinstance(source, bytes | bytearray | memoryview):
        data = bytes(source)
    else:
        name, data = getattr(source, "name", name), source.read()
        if not isinstance(data, bytes):
            raise FileError(f'{name}: is open as text; open it as bytes: open(path, "rb")')
    start = data.removeprefix(b"\xef\xbb\xbf")
    matches = {end: re.match(one.suffixes[end], start) for end, one in BY_SUFFIX.items()}
    lengths = {end: match.end() for end, match in matches.items() if match}
    ending = max(lengths, key=lengths.__getitem__, default=".stl" if len(start) > STL else "")
    stem = Path(str(name).strip("<>")).stem or "bytes"
    with TemporaryDirectory() as folder:
        path = Path(folder, stem + ending)
        path.write_bytes(data)
        yield path
