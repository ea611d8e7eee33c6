"""Reading and writing whole files, with errors that name them."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import CutcellError, FileError


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
        raise FileError(f"{path}: cannot be read ({_reason(e)})") from None
    if not data:
        raise FileError(f"{path.name}: the file is empty")
    return data


def read_text(path: Path) -> str:
    """Read a text file in UTF-8."""
    try:
        return read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as e:
        raise FileError(f"{path.name}: is not a text file (byte {e.start} is not UTF-8)") from None


def write_all(contents: dict[Path, bytes]) -> None:
    """Write files so that a failure leaves the old ones as they were.

    Everything is written under temporary names in the same folders first, then renamed
    in the order given.
    """
    written: list[tuple[Path, Path]] = []
    try:
        for path, data in contents.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            real = path.resolve()  # through a link, not over it
            written.append((_write_beside(real, data), real))
        for temporary, real in written:
            os.replace(temporary, real)
    except OSError as e:
        raise FileError(f"{path}: cannot be written ({_reason(e)})") from None
    finally:
        for temporary, _ in written:
            temporary.unlink(missing_ok=True)


def _write_beside(path: Path, data: bytes) -> Path:
    temporary = path.with_name(f".{path.name[:40]}.{secrets.token_hex(4)}")
    try:
        with temporary.open("xb") as file:
            file.write(data)
        if path.exists():
            shutil.copymode(path, temporary)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return temporary


def _reason(error: BaseException) -> str:
    return getattr(error, "strerror", None) or str(error)
