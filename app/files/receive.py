"""Files from the browser, received in pieces and written to the upload cache."""

from collections.abc import Callable
from typing import Any

from cutcell.errors import FileError

from ..server.messages import FULL
from ..server.protocol.reading import read
from ..server.protocol.received import (
    Announced,
    Message,
    UploadBegin,
    UploadCancel,
    UploadEnd,
    UploadPiece,
)
from .upload_cache import Group, UploadCache

MAX_UPLOAD = 200 * 1024 * 1024
"""The largest file that the page takes, in bytes."""

MAX_FILES = 64

NAME_BYTES = 200
"""Longest name of a file: most systems allow 255, and exports of the file have longer names."""


class Receiver:
    """Receives the files of one browser into a cache, as those of one page, their owner.

    It calls `received` with each complete group, and `refused` with the error of any other.
    """

    def __init__(
        self,
        cache: UploadCache,
        owner: object,
        received: Callable[[Group], None],
        refused: Callable[[Exception], None],
    ) -> None:
        self._cache = cache
        self._owner = owner
        self._received = received
        self._refused = refused
        self._group: Group | None = None
        self._sizes: list[int] = []

    def answer(self, message: dict[str, Any]) -> dict[str, Any] | None:
        """Handle a message and return the answer, also after an error; None for other messages."""
        if not str(message.get("type")).startswith("upload-"):
            return None
        try:
            self._receive(read(message))
        except Exception as error:
            self.drop()
            problem = _problem(error)
            self._refused(problem)
            return {"ok": False, "message": str(problem)}
        return {"ok": True}

    def drop(self) -> None:
        """Remove an incomplete group."""
        group, self._group = self._group, None
        if group is not None:
            self._cache.drop(group)

    def _receive(self, message: Message) -> None:
        match message:
            case UploadBegin(files):
                self._begin(files)
            case UploadPiece(index, data):
                self._piece(index, data)
            case UploadEnd():
                self._end()
            case UploadCancel(unreadable):
                self.drop()
                if unreadable:
                    raise FileError("the browser could not read the file; was it moved or changed?")

    def _begin(self, files: list[Announced]) -> None:
        self.drop()
        names, sizes = _announced(files)
        group = self._group = self._cache.begin(sum(sizes), self._owner)
        group.paths = [group.folder / name for name in names]
        self._sizes = sizes
        for path in group.paths:
            path.touch()

    def _piece(self, index: int, data: bytes) -> None:
        group = self._group
        if group is None or not 0 <= index < len(self._sizes):
            raise FileError("a piece of a file came that nothing had announced; try again")
        if group.written + len(data) > group.size:
            raise FileError("more came than was announced; try again")
        with group.paths[index].open("ab") as file:
            file.write(data)
        group.written += len(data)

    def _end(self) -> None:
        group = self._group
        if group is None:
            raise FileError("no files were announced; try again")
        sizes = zip(group.paths, self._sizes, strict=True)
        short = [path.name for path, size in sizes if path.stat().st_size != size]
        if short:
            raise FileError(f'"{", ".join(short)}" did not arrive whole; try again')
        self._group = None
        self._received(group)


def _announced(files: list[Announced]) -> tuple[list[str], list[int]]:
    """Return the names and sizes of announced files."""
    if not 0 < len(files) <= MAX_FILES:
        raise FileError(f"{len(files)} files came at once; 1 to {MAX_FILES} can be opened")
    names = [safe_name(file["name"]) for file in files]
    sizes = [file["size"] for file in files]
    for name, size in zip(names, sizes, strict=True):
        if not 0 <= size <= MAX_UPLOAD:
            raise FileError(
                f'"{name}" has {size / 2**20:,.0f} MB; the page takes files '
                f"of up to {MAX_UPLOAD // 2**20} MB (the cutcell command takes any)"
            )
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise FileError(f'two of the files are called "{min(twice)}"; give them names of their own')
    return names, sizes


def _problem(error: Exception) -> Exception:
    """Return the text of an error for a person."""
    if isinstance(error, OSError):
        if error.errno in FULL:
            return FileError("the server's disk is full, and the file was not taken; try again")
        return FileError(f"the server could not store the file ({error.strerror}); try again")
    return error


def safe_name(name: str) -> str:
    """Return the last part of a name from the browser, fit to be a file's name here."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    printable = "".join(c for c in last if c.isprintable() and c not in '<>:"|?*').strip(". ")
    # Systems count bytes; a long name keeps its end.
    return printable.encode()[-NAME_BYTES:].decode(errors="ignore").strip(". ") or "file"
