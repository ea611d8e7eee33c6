"""Files that are written whole or not at all.

Contents go to temporary files in the same folder, which are renamed once all are on the disk.
Later writers to that folder remove the temporary files of a process that was killed, after some
hours.
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import FileError

MARK = ".cutcell-"
"""How the names of temporary files begin. They are short, however long the file's own is."""
TEMPORARY = re.compile(re.escape(MARK) + r"[0-9a-f]{16}(\.\w+)?")
STALE = 6 * 3600
"""Seconds without a change after which nobody writes a temporary file any more."""


@contextmanager
def replacing(*paths: Path) -> Iterator[list[Path]]:
    """Yield temporary files, which replace `paths`, in this order, when the block ends.

    If the block raises, or a file cannot be written, the old files stay as they were.
    """
    unready: list[Path] = []
    try:
        targets = [Path(os.path.realpath(path)) for path in paths]  # through a link, not over it
        for folder in {target.parent for target in targets}:
            sweep(folder)
        for target in targets:
            unready.append(target.with_name(f"{MARK}{secrets.token_hex(8)}{target.suffix}"))
            unready[-1].open("xb").close()
        yield unready
        for temporary, target in zip(unready, targets, strict=True):
            with temporary.open("rb+") as file:
                os.fsync(file.fileno())
            if target.exists():
                shutil.copymode(target, temporary)
        for temporary, target in zip(unready, targets, strict=True):
            os.replace(temporary, target)
    except OSError as error:
        raise FileError(f"{paths[-1].name}: cannot be written ({reason(error)})") from None
    finally:
        for temporary in unready:
            with suppress(OSError):
                temporary.unlink()


def write_all(contents: Mapping[Path, bytes]) -> None:
    """Write files, all or none; folders that are not there are made."""
    try:
        for path in contents:
            path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{path.parent}: cannot be made ({reason(error)})") from None
    with replacing(*contents) as unready:
        for temporary, data in zip(unready, contents.values(), strict=True):
            temporary.write_bytes(data)


def check_place(path: Path) -> None:
    """Raise what would stop a file from being written, before its contents are computed."""
    if not path.absolute().parent.is_dir():
        raise FileError(f"{path.name}: there is no folder {path.parent} to save it in")
    try:
        os.lstat(path)
    except FileNotFoundError:
        pass
    except (OSError, ValueError) as error:  # ValueError: a null byte
        raise FileError(f"{path.name}: cannot be written ({reason(error)})") from None
    if path.is_dir():
        raise FileError(f"{path.name}: is a folder; name a file")
    if not os.access(os.path.dirname(os.path.realpath(path)), os.W_OK | os.X_OK):
        raise FileError(f"{path.name}: the folder {path.parent} cannot be written to")


def sweep(folder: Path) -> None:
    """Remove the temporary files that killed processes left in a folder."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if TEMPORARY.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                with suppress(OSError):
                    if time.time() - entry.stat().st_mtime > STALE:
                        os.unlink(entry.path)


def reason(error: BaseException) -> str:
    """Return why the system refused something, in words."""
    return getattr(error, "strerror", None) or str(error)
