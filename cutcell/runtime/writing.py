"""Files that are written whole or not at all.

What is written goes to temporary files in the same folder, and from there to its place when all
of it is on the disk. A process that is killed leaves its temporary files behind; whoever writes to
that folder next removes them. It knows them by their names, and that nobody writes them any more by
the lock that their writer held.
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from ..errors import FileError

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

MARK = ".cutcell-"
"""How the names of temporary files begin. They are short, however long the file's own is."""
TEMPORARY = re.compile(re.escape(MARK) + r"[0-9a-f]{16}(\.\w+)?")


@contextmanager
def replacing(*paths: Path) -> Iterator[list[Path]]:
    """Give temporary files to be written; they take the place of `paths` when the block is left.

    If the block raises, or a file cannot be written, the old files stay as they were.
    """
    with ExitStack() as stack:
        try:
            # Through a link, not over it.
            targets = [Path(os.path.realpath(path)) for path in paths]
            for folder in {target.parent for target in targets}:
                sweep(folder)
            unready = [stack.enter_context(_temporary(target)) for target in targets]
            yield unready
            for temporary, target in zip(unready, targets, strict=True):
                _finish(temporary, target)
            _put_in_place(list(zip(unready, targets, strict=True)))
        except OSError as error:
            raise FileError(f"{paths[-1].name}: cannot be written ({reason(error)})") from None


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
    """Meet what would stop a file from being written before the work that it shall hold."""
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
                with suppress(OSError), open(entry.path, "rb") as file:
                    _lock(file)  # raises while its writer lives
                    os.unlink(entry.path)


def reason(error: BaseException) -> str:
    """Return why the system refused something, in words."""
    return getattr(error, "strerror", None) or str(error)


@contextmanager
def _temporary(target: Path) -> Iterator[Path]:
    """Make a temporary file beside another, locked for as long as it is needed."""
    while True:
        path = target.with_name(f"{MARK}{secrets.token_hex(8)}{target.suffix}")
        with path.open("xb") as file:
            try:
                _lock(file, waiting=True)
                if not path.exists():
                    continue  # swept before it was locked
                if fcntl is None:
                    file.close()  # Windows does not rename what is open
                yield path
                return
            finally:
                path.unlink(missing_ok=True)


def _lock(file: BinaryIO, waiting: bool = False) -> None:
    """Lock a file, or raise OSError where it is locked; without locks nothing is ever swept."""
    try:
        if fcntl is None:
            raise OSError("this system has no such locks")
        fcntl.flock(file, fcntl.LOCK_EX | (0 if waiting else fcntl.LOCK_NB))
    except OSError:
        if not waiting:
            raise


def _finish(temporary: Path, target: Path) -> None:
    """Let a file be on the disk before it gets its name, and have the rights of the old one."""
    with temporary.open("rb+") as file:
        os.fsync(file.fileno())
    if target.exists():
        shutil.copymode(target, temporary)


def _put_in_place(pairs: list[tuple[Path, Path]]) -> None:
    """Rename all files; if one cannot be, or Ctrl-C comes between, put the old ones back."""
    replaced: list[tuple[Path | None, Path]] = []
    try:
        for temporary, target in pairs[:-1]:
            old = target.with_name(f"{MARK}{secrets.token_hex(8)}") if target.exists() else None
            if old is not None:
                _keep(target, old)
            replaced.append((old, target))
            os.replace(temporary, target)
        os.replace(*pairs[-1])
    except BaseException:
        for old, target in replaced:
            with suppress(OSError):
                os.replace(old, target) if old else target.unlink()
        raise
    finally:
        for old, _ in replaced:
            if old is not None:
                old.unlink(missing_ok=True)


def _keep(target: Path, old: Path) -> None:
    try:
        os.link(target, old)
    except OSError:  # file systems without hard links
        shutil.copy2(target, old)
