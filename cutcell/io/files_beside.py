"""Files that another one names: read only from its own folder, or below it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath

from ..errors import FileError
from .files import read_bytes

LARGEST = 2**28
"""Bytes of such a file."""


def read_beside(path: Path, names: Iterable[str], label: str, largest: int = LARGEST) -> bytes:
    """Return what is in the first of some files that is there.

    A file may come from a stranger, over the page; it must not reach other files. Names are those
    of the machine that it was made on: where one leads elsewhere, the file is looked for under its
    last part in the folder itself.
    """
    folder = path.parent.resolve()
    for name in _tried(names):
        try:
            found = folder.joinpath(name).resolve()
            if not found.is_relative_to(folder) or not found.is_file():
                continue
            size = found.stat().st_size
        except (OSError, ValueError, RuntimeError):  # too long a name; links in a circle
            continue
        if size > largest:
            raise FileError(f"{label} has {size / 2**20:,.0f} MB, more than is read")
        return read_bytes(found)
    raise FileError(f"{label} is not in the folder of {path.name}")


def _tried(names: Iterable[str]) -> Iterator[PurePosixPath]:
    """Return where files may be, seen from the folder: each as it is named, then by its name."""
    named = [PurePosixPath(name.replace("\\", "/")) for name in names if name and "\0" not in name]
    for one in named:
        if not one.is_absolute() and ".." not in one.parts and ":" not in str(one):
            yield one
    for one in named:
        if one.name and one.name != ".." and ":" not in one.name:
            yield PurePosixPath(one.name)
