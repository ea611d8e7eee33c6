"""Uploaded files: stored while a page uses them, and some time longer for returning visitors.

All of them together have a quota, and so have those of one page. Files that are no longer in use
are removed for new ones.
"""

import atexit
import secrets
import shutil
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from cutcell.errors import FileError

from .storage import Storage

KEPT_SECONDS = 15 * 60.0
"""How long files stay when no page uses them any more."""

MB = 2**20
MAX_BYTES = 2048 * MB
"""Quota of all uploaded files together."""
MAX_OF_A_PAGE = 500 * MB
"""Quota of the files of one page that still exist."""
SPARE_BYTES = 256 * MB
"""Space that uploads leave free on the disk."""

SWEEP_SECONDS = 60.0


@dataclass(eq=False)
class Group:
    """Files that belong together.

    Parameters
    ----------
    key : str
        Cannot be guessed.
    folder : Path
    size : int
        Bytes, of all of them, as they were announced.
    owner : object
        The page that sends them.
    users : int
        Pages on which their character stands, or is about to.
    listed : int
        Open pages on which it can be chosen again. It waits for that, but makes way for others.
    """

    key: str
    folder: Path
    size: int
    owner: object
    paths: list[Path] = field(default_factory=list)
    users: int = 1
    listed: int = 0
    left: float = 0.0


class UploadCache:
    """Groups of uploaded files.

    Parameters
    ----------
    storage : Storage, optional
    seconds : float
        How long a group stays when no page uses it any more.
    """

    def __init__(self, storage: Storage | None = None, seconds: float = KEPT_SECONDS) -> None:
        self.storage = storage or Storage()
        self._seconds = seconds
        self._lock = threading.Lock()
        self._groups: dict[str, Group] = {}

    def begin(self, size: int, owner: object) -> Group:
        """Free storage for a group of files, and make its folder; it is in use.

        Raises
        ------
        FileError
            The files, with those that are there, are more than a page or the server may hold,
            or more than fits on the disk.
        OSError
            No folder can be made.
        """
        with self._lock:
            self._sweep()
            self._check_page(size, owner)
            self._check_all(size)
            group = Group(secrets.token_urlsafe(9), self.storage.make(), size, owner)
            self._groups[group.key] = group
            return group

    def drop(self, group: Group) -> None:
        """Remove a group of files that did not arrive."""
        with self._lock:
            self._remove(group)

    def take(self, key: str) -> list[Path] | None:
        """Use a group of files; None where it is not kept any more."""
        with self._lock:
            self._sweep()
            group = self._groups.get(key)
            if group is None or not group.paths:
                return None
            group.users += 1
            return group.paths

    def leave(self, key: str) -> None:
        """Use a group of files no longer; it stays for a while."""
        with self._lock:
            group = self._groups.get(key)
            if group is not None:
                group.users -= 1
                group.left = time.monotonic()
            self._sweep()

    def list(self, key: str, count: int = 1) -> None:
        """Note that one more page lists a group of files; with -1, that one does no longer."""
        with self._lock:
            group = self._groups.get(key)
            if group is not None:
                group.listed += count
                group.left = time.monotonic()

    def has(self, key: str) -> bool:
        """Whether a group of files is still kept."""
        with self._lock:
            return key in self._groups

    def sweep(self) -> None:
        """Remove what was left long ago, here and by servers that ended."""
        with self._lock:
            self._sweep()
        self.storage.sweep()

    def sweep_by_the_clock(self) -> None:
        """Sweep now, and once a minute for as long as the process lives."""

        def sweep() -> None:
            while True:
                self.sweep()
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
        if self.storage.free() - size < SPARE_BYTES:
            self._make_room(MAX_BYTES, MAX_BYTES)  # whatever nobody uses
        free = self.storage.free()
        if free - size < SPARE_BYTES:
            raise FileError(
                f"the server's disk has no room for {_mb(size)}: {_mb(free)} are free, and "
                f"{_mb(SPARE_BYTES)} must stay so"
            )

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

    Parameters
    ----------
    cache : UploadCache

    Attributes
    ----------
    key : str
        Key of the open character; empty where it was not uploaded.
    listed : dict of str to str
        The keys of the characters that stood there, and what they are called, in order.
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
        """Use a group of files; None where it is not kept any more."""
        if key in self._in_use:
            self.cache.leave(key)
        paths = self.cache.take(key)
        if paths is not None:
            self.hold(key)
        return paths

    def stay(self, key: str, name: str = "") -> None:
        """Use the files of the open character and no others; "" for none.

        It can be chosen again by its name, if it has one.
        """
        self.key = key
        if key and name and key not in self.listed:
            self.listed[key] = name
            self.cache.list(key)
        for other in self._in_use - {key}:
            self.leave(other)

    def leave(self, key: str) -> None:
        """Stop using files, unless their character is open."""
        if key in self._in_use and key != self.key:
            self._in_use.remove(key)
            self.cache.leave(key)

    def offered(self) -> dict[str, str]:
        """Return what is `listed` and still kept."""
        return {key: name for key, name in self.listed.items() if self.cache.has(key)}

    def when_closed(self, act: Callable[[], None]) -> None:
        """Do something when the page is closed."""
        self._closing.append(act)

    def close(self) -> None:
        """Release uploaded files, and those that are still being sent."""
        self.stay("")
        for key in self.listed:
            self.cache.list(key, -1)
        self.listed.clear()
        for act in self._closing:
            act()


def _mb(size: int) -> str:
    return f"{size / MB:,.0f} MB"


UPLOADS = UploadCache()
"""That of this server."""
atexit.register(UPLOADS.close)
