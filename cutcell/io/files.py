"""What is loaded: files, bytes, open files and pipes; errors that name the file."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import BinaryIO

from ..errors import CutcellError, FileError
from ..runtime.writing import reason
from .formats import BY_SUFFIX

MAX_QUOTED = 200
"""Characters of what another library says."""
LONGEST_SENTENCE = 1000
MAX_FILE_BYTES = 2**28
"""Bytes of a file that another one names."""


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the file's name in front of every cutcell error raised inside, the innermost one's."""
    try:
        yield
    except CutcellError as e:
        if "named" in vars(e):
            raise
        named, sentence = e, str(e)
        if not sentence.startswith((f"{path}:", f"{path.name}:")):
            sentence = f"{path.name}: {sentence}"
        sentence = _short(sentence)
        if sentence != str(e):
            named = type(e)(sentence)
        vars(named)["named"] = True
        if named is e:
            raise
        raise named from e


def _short(sentence: str) -> str:
    """Return a sentence on one line, cut in the middle: files hold words of any kind and length."""
    sentence = " ".join(sentence.splitlines())
    if len(sentence) <= LONGEST_SENTENCE:
        return sentence
    half = LONGEST_SENTENCE // 2
    return f"{sentence[:half]} ... {sentence[-half:]}"


def read_bytes(path: Path, most: int | None = None) -> bytes:
    """Read a file that must exist, be a file, and hold something, or its first `most` bytes."""
    try:
        with path.open("rb") as file:
            data = file.read() if most is None else file.read(min(most, path.stat().st_size))
    except FileNotFoundError:
        raise FileError(f"{path}: there is no such file") from None
    except IsADirectoryError:
        raise FileError(f"{path}: is a folder; give a file in it") from None
    except (OSError, ValueError) as e:  # ValueError: a null byte in the path
        raise FileError(f"{path}: cannot be read ({reason(e)})") from None
    if not data:
        raise FileError(f"{path.name}: the file is empty")
    return data


def one_line(error: Exception) -> str:
    """Return what another library says of a file, as part of a sentence."""
    message = " ".join(str(error).split()) or type(error).__name__
    return message if len(message) <= MAX_QUOTED else f"{message[:MAX_QUOTED]}..."


def read_text(path: Path) -> str:
    """Read a text file in UTF-8."""
    try:
        return read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as e:
        raise FileError(f"{path.name}: is not a text file (byte {e.start} is not UTF-8)") from None


def read_beside(
    path: Path, names: Iterable[str], label: str, largest: int = MAX_FILE_BYTES
) -> bytes:
    """Return what is in the first of some files that is there, in the folder or below it.

    A file may name others by their places on another machine.
    """
    for name in _tried(names):
        file = regular_file(path.parent / name, path.parent)
        if file is not None:
            size = file.stat().st_size
            if size > largest:
                raise FileError(f"{label} has {size / 2**20:,.0f} MB, more than is read")
            return read_bytes(file, largest)
    raise FileError(f"{label} is not in the folder of {path.name}")


def regular_file(file: Path, folder: Path) -> Path | None:
    """Return a file without the links that lead to it, None where no file is.

    Strangers send folders: a link out of it, a pipe and a device are refused, before they are open.
    """
    try:
        real = file.resolve(strict=True)
    except (OSError, ValueError, RuntimeError):  # too long a name; links in a circle
        return None
    if real.is_dir():
        return None
    if real.is_file() and real.is_relative_to(folder.resolve()):
        return real
    kind = "a file outside of its folder" if real.is_file() else "a pipe or a device"
    raise FileError(f'"{file.name[:80]}" is {kind}, which is not read; put a copy there')


def _tried(names: Iterable[str]) -> Iterator[PurePosixPath]:
    """Return where files may be, seen from the folder: each as it is named, then by its name."""
    named = [PurePosixPath(name.replace("\\", "/")) for name in names if name and "\0" not in name]
    for one in named:
        if not one.is_absolute() and ".." not in one.parts and ":" not in str(one):
            yield one
    for one in named:
        if one.name and one.name != ".." and ":" not in one.name:
            yield PurePosixPath(one.name)


LEAST = 2**28
PER_BYTE = 256
"""Bytes that a file of no size, and each of its bytes, may take while it is read. Weights of a
thousand joints for each vertex take some 200 times as much as what they are stored in."""


class Allowance:
    """The rest of the memory that a file may use, since a few bytes can ask for any amount."""

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


def whole_characters(text: str) -> str:
    """Return a text with � in place of each surrogate without its pair, which is no character."""
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def has_halves(text: str) -> bool:
    """Return whether a text has surrogates without their pair."""
    return not text.isascii() and whole_characters(text) != text


HALVES = "a name in it holds half of a character (a lone surrogate), for which � stands"
"""The warning of a file with such names."""


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
    ending = max(lengths, key=lengths.__getitem__, default=".stl" if len(start) >= STL else "")
    stem = Path(str(name).strip("<>")).stem or "bytes"
    with TemporaryDirectory() as folder:
        path = Path(folder, stem + ending)
        path.write_bytes(data)
        yield path
