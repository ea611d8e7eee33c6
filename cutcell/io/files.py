"""Reading whole files, with errors that name them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import CutcellError, FileError
from ..writing import reason

LONGEST = 200
"""Characters of what another library says."""


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the file's name in front of every cutcell error raised inside.

    Where several of these stand inside each other, the innermost knows best.
    """
    try:
        yield
    except CutcellError as e:
        if "named" in vars(e):
            raise
        named = e
        if not str(e).startswith((f"{path}:", f"{path.name}:")):
            named = type(e)(f"{path.name}: {e}")
        vars(named)["named"] = True
        if named is e:
            raise
        raise named from e


def read_bytes(path: Path) -> bytes:
    """Read a file that must exist, be a file, and hold something."""
    try:
        data = path.read_bytes()
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
    said = " ".join(str(error).split()) or type(error).__name__
    return said if len(said) <= LONGEST else f"{said[:LONGEST]}..."


def read_text(path: Path) -> str:
    """Read a text file in UTF-8."""
    try:
        return read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as e:
        raise FileError(f"{path.name}: is not a text file (byte {e.start} is not UTF-8)") from None
