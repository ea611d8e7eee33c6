"""Storage of a server's files: one folder, locked for as long as the server lives.

Other servers remove the folder of a server that was killed.
"""

import os
import shutil
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import IO

PREFIX = "cutcell-"
LOCK = "lock"

NEW_SECONDS = 60.0
"""Age up to which a folder may belong to a server that has not locked it yet."""

UNKNOWN_SECONDS = 24 * 3600.0
"""Age up to which a folder without a lock is kept: a picture in progress, or an older version."""


class Storage:
    """Folders for files, inside one that ends with the server, in the temporary folder."""

    def __init__(self, parent: Path | None = None) -> None:
        self._parent = parent
        self._guard = threading.Lock()
        self._root: Path | None = None
        self._lock: IO[bytes] | None = None

    @property
    def parent(self) -> Path:
        """The folder that contains the server's folder."""
        return self._parent or Path(tempfile.gettempdir())

    def make(self) -> Path:
        """Make a new, empty folder; return its path."""
        with self._guard:
            if self._root is None or not (self._root / LOCK).is_file():
                self._begin()  # at first, and after someone has removed it
            return Path(tempfile.mkdtemp(dir=self._root))

    def free(self) -> int:
        """Return how many bytes the disk has left."""
        return shutil.disk_usage(self.parent).free

    def sweep(self) -> None:
        """Remove the folders that ended servers left."""
        uid = getattr(os, "getuid", lambda: None)()
        with suppress(OSError), os.scandir(self.parent) as entries:
            for entry in entries:
                with suppress(OSError):  # removed in the meantime, or not readable
                    if not entry.name.startswith(PREFIX) or not entry.is_dir(follow_symlinks=False):
                        continue
                    # Other users can write to the temporary folder, too.
                    if uid is None or entry.stat(follow_symlinks=False).st_uid == uid:
                        _remove_if_left(Path(entry.path))

    def close(self) -> None:
        """Remove everything."""
        with self._guard:
            if self._lock is not None:
                self._lock.close()
            if self._root is not None:
                shutil.rmtree(self._root, ignore_errors=True)
            self._root = self._lock = None

    def _begin(self) -> None:
        if self._lock is not None:
            self._lock.close()
        self._root = Path(tempfile.mkdtemp(prefix=PREFIX, dir=self.parent))
        self._lock = (self._root / LOCK).open("wb")
        _locked(self._lock)


def _remove_if_left(folder: Path) -> None:
    try:
        file = (folder / LOCK).open("rb+")
    except FileNotFoundError:
        left = _age(folder) > UNKNOWN_SECONDS
    else:
        with file:
            left = _locked(file) and _age(folder) > NEW_SECONDS
    if left:
        shutil.rmtree(folder, ignore_errors=True)


def _age(path: Path) -> float:
    return time.time() - path.lstat().st_mtime


def _locked(file: IO[bytes]) -> bool:
    """Lock a file until it is closed or its process ends; False if another process locks it."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
