"""Uploaded files: stored while a page uses them, and some time longer for returning visitors.

There are quotas for one page and for all pages. Unused files are removed for new ones.
"""

import atexit
import secrets
import shutil
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cutcell.errors import FileError

from .storage import Storage

STORED_SECONDS = 15 * 60.0
"""Time that files are kept after their last use."""

MB = 2**20
MAX_BYTES = 2048 * MB
"""Quota of all uploaded files together."""
MAX_OF_A_PAGE = 500 * MB
"""Quota of the files of one page."""
SPARE_BYTES = 256 * MB
"""Space that uploads leave free on the disk."""

SWEEP_SECONDS = 60.0


@dataclass(eq=False)
class Group:
    """Files that belong together, by a key that cannot be guessed.

    Parameters
    ----------
    size : int
        Bytes of all files, as announced.
    owner : object
        The page that sent them.
    written : int
        Bytes that have arrived; the disk keeps room for the others.
    users : int
        Number of pages on which their character is open, or is being opened.
    listed : int
        Number of open pages that list it. It is kept for them unless others need the space.
    left : float
        Time of its last use.
    is_made : bool
        Whether the page made them: a person does not have them.
    """

    key: str
    folder: Path
    size: int
    owner: object
    paths: list[Path] = field(default_factory=list)
    written: int = 0
    users: int = 1
    listed: int = 0
    left: float = 0.0
    is_made: bool = False


class UploadCache:
    """Groups of uploaded files, which are kept for some seconds after their last use."""

    def __init__(self, storage: Storage | None = None, seconds: float = STORED_SECONDS) -> None:
        self.storage = storage or Storage()
        self._seconds = seconds
        self._lock = threading.Lock()
        self._groups: dict[str, Group] = {}

    def begin(self, size: int, owner: object) -> Group:
        """Return a new group in use; raise a `FileError` if it exceeds a quota or the disk."""
        with self._lock:
            self._sweep()
            self._check_page(size, owner)
            self._check_all(size)
            group = Group(secrets.token_urlsafe(9), self.storage.make(), size, owner)
            self._groups[group.key] = group
            return group

    def drop(self, group: Group) -> None:
        """Remove an incomplete group."""
        with self._lock:
            self._remove(group)

    def take(self, key: str) -> list[Path] | None:
        """Use a group and return its files; None if it is no longer kept."""
        with self._lock:
            self._sweep()
            group = self._groups.get(key)
            if group is None or not group.paths:
                return None
            group.users += 1
            return group.paths

    def leave(self, key: str) -> None:
        """Stop using a group, which is kept for a while."""
        with self._lock:
            group = self._groups.get(key)
            if group is not None:
                group.users -= 1
                group.left = time.monotonic()
            self._sweep()

    def list(self, key: str, count: int = 1) -> None:
        """Add to the number of pages that list a group."""
        with self._lock:
            group = self._groups.get(key)
            if group is not None:
                group.listed += count
                group.left = time.monotonic()

    def made(self, key: str) -> dict[str, bytes]:
        """Return the names and contents of files that the page made; none for others."""
        with self._lock:
            group = self._groups.get(key)
            paths = group.paths if group is not None and group.is_made else []
            return {path.name: path.read_bytes() for path in paths}

    def has(self, key: str) -> bool:
        """Return whether a group is still kept."""
        with self._lock:
            return key in self._groups

    def sweep(self) -> None:
        """Remove old unused groups, and folders of servers that have ended."""
        with self._lock:
            self._sweep()
        self.storage.sweep()

    def sweep_by_the_clock(self, *others: Callable[[], None]) -> None:
        """Sweep now and once a minute, others too."""

        def sweep() -> None:
            while True:
                for one in (self.sweep, *others):
                    one()
                time.sleep(SWEEP_SECONDS)

        threading.Thread(target=sweep, daemon=True, name="cutcell sweep").start()

    def close(self) -> None:
        """Remove everything."""
        with self._lock:
            self._groups.clear()
        self.storage.close()

    def _check_page(self, size: int, owner: object) -> None:
        if size > MAX_OF_A_PAGE:
            raise FileError(
                f"the files have {_mb(size)} together; a page takes {_mb(MAX_OF_A_PAGE)} (the "
                "cutcell command takes any)"
            )
        used = self._make_room(size, MAX_OF_A_PAGE, owner)
        if used + size > MAX_OF_A_PAGE:
            raise FileError(
                f"this page uses {_mb(used)} of uploads, of at most {_mb(MAX_OF_A_PAGE)}; reload "
                "it, or open the file by the cutcell command"
            )

    def _check_all(self, size: int) -> None:
        used = self._make_room(size, MAX_BYTES)
        if used + size > MAX_BYTES:
            raise FileError(
                f"{_mb(used)} of uploads are in use, of at most {_mb(MAX_BYTES)}; try again later"
            )
        if self._free() - size < SPARE_BYTES:
            self._make_room(MAX_BYTES, MAX_BYTES)  # all unused files
        free = self._free()
        if free - size < SPARE_BYTES:
            raise FileError(
                f"the server's disk has no room for {_mb(size)}: {_mb(max(free, 0))} are free, and "
                f"{_mb(SPARE_BYTES)} must stay so"
            )

    def _free(self) -> int:
        """Return how many bytes the disk has left once all that was announced has arrived."""
        expected = sum(group.size - group.written for group in self._groups.values())
        return self.storage.free() - expected

    def _make_room(self, size: int, most: int, owner: object = None) -> int:
        """Remove unused files, the oldest first, until a size fits; return the size of the rest."""
        groups = [one for one in self._groups.values() if owner in (None, one.owner)]
        used = sum(group.size for group in groups)
        unused = (group for group in groups if group.users <= 0)
        for group in sorted(unused, key=lambda group: group.left):
            if used + size <= most:
                break
            self._remove(group)
            used -= group.size
        return used

    def _sweep(self) -> None:
        old = time.monotonic() - self._seconds
        for group in list(self._groups.values()):
            if group.users <= 0 and group.listed <= 0 and group.left <= old:
                self._remove(group)

    def _remove(self, group: Group) -> None:
        self._groups.pop(group.key, None)
        shutil.rmtree(group.folder, ignore_errors=True)


class PageUploads:
    """The uploaded files that one page uses.

    `key` is that of the open character, empty if it was not uploaded; `listed` has the keys and
    names of the characters that were opened, in order.
    """

    def __init__(self, cache: UploadCache) -> None:
        self.cache = cache
        self.key = ""
        self.listed: dict[str, str] = {}
        self._in_use: set[str] = set()
        self._closing: list[Callable[[], None]] = []

    def hold(self, key: str) -> None:
        """Note files that are in use already."""
        self._in_use.add(key)

    def take(self, key: str) -> list[Path] | None:
        """Use a group and return its files; None if it is no longer kept."""
        if key in self._in_use:
            self.cache.leave(key)
        paths = self.cache.take(key)
        if paths is not None:
            self.hold(key)
        return paths

    def stay(self, key: str, name: str = "") -> None:
        """Use the files of the open character and no others; list it by its name, if it has one."""
        self.key = key
        if key and name and key not in self.listed:
            self.listed[key] = name
            self.cache.list(key)
        for other in self._in_use - {key}:
            self.leave(other)

    def list_again(self, listed: Mapping[str, str]) -> None:
        """List what the page before a reload listed."""
        self.listed |= listed
        for key in listed:
            self.cache.list(key)

    def leave(self, key: str) -> None:
        """Stop using files, unless their character is open."""
        if key in self._in_use and key != self.key:
            self._in_use.remove(key)
            self.cache.leave(key)

    def offered(self) -> dict[str, str]:
        """Return the listed characters whose files are still kept."""
        return {key: name for key, name in self.listed.items() if self.cache.has(key)}

    def when_closed(self, act: Callable[[], None]) -> None:
        """Call a function when the page is closed."""
        self._closing.append(act)

    def close(self) -> None:
        """Release all files, also incomplete ones."""
        self.stay("")
        for key in self.listed:
            self.cache.list(key, -1)
        self.listed.clear()
        for act in self._closing:
            act()


def _mb(size: int) -> str:
    return f"{size / MB:,.0f} MB"


UPLOADS = UploadCache()
"""The cache of this server."""
atexit.register(UPLOADS.close)
