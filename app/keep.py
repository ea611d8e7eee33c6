"""Uploaded files: kept while a page uses them, and some time longer, for whoever comes back."""

from __future__ import annotations

import atexit
import secrets
import shutil
import tempfile
import threading
import time
from pathlib import Path

KEPT_SECONDS = 15 * 60.0
"""How long files stay when no page uses them any more."""


class Keep:
    """Folders of uploaded files, each under a key that cannot be guessed."""

    def __init__(self, seconds: float = KEPT_SECONDS) -> None:
        self._seconds = seconds
        self._lock = threading.Lock()
        self._root: tempfile.TemporaryDirectory[str] | None = None
        self._used: dict[str, int] = {}
        self._left: dict[str, float] = {}
        self._paths: dict[str, list[Path]] = {}

    def put(self, paths: list[Path]) -> tuple[str, list[Path]]:
        """Move a group of files here; return its key, and where they are now. It is in use."""
        with self._lock:
            if self._root is None:
                self._root = tempfile.TemporaryDirectory(
                    prefix="cutcell-kept-", ignore_cleanup_errors=True
                )
            key = secrets.token_urlsafe(9)
            folder = Path(self._root.name) / key
            folder.mkdir()
            here = [Path(shutil.move(path, folder / path.name)) for path in paths]
            self._paths[key], self._used[key] = here, 1
        self.sweep()
        return key, here

    def take(self, key: str) -> list[Path] | None:
        """Use a group of files; None where it is not kept any more."""
        self.sweep()
        with self._lock:
            if key not in self._paths:
                return None
            self._used[key] += 1
            self._left.pop(key, None)
            return self._paths[key]

    def leave(self, key: str) -> None:
        """Use a group of files no longer; it stays for a while."""
        with self._lock:
            if key in self._used:
                self._used[key] -= 1
                if self._used[key] <= 0:
                    self._left[key] = time.monotonic()
        self.sweep()

    def close(self) -> None:
        """Remove everything."""
        with self._lock:
            if self._root is not None:
                self._root.cleanup()
            self._root = None
            for kept in (self._used, self._left, self._paths):
                kept.clear()

    def sweep(self) -> None:
        """Remove what was left long ago."""
        with self._lock:
            old = time.monotonic() - self._seconds
            for key in [key for key, when in self._left.items() if when <= old]:
                shutil.rmtree(self._paths.pop(key)[0].parent, ignore_errors=True)
                del self._left[key], self._used[key]


KEEP = Keep()
"""That of this server."""
atexit.register(KEEP.close)
