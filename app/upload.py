"""Files from the browser: received in pieces, straight to a folder of the session."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import param
from panel.custom import JSComponent

from cutcell.errors import CutcellError, FileError

from .scripts import script
from .state import MAX_UPLOAD

MAX_FILES = 64


class Receiver:
    """Writes the files that one browser sends.

    Parameters
    ----------
    folder : Path
        Where each group of files gets a folder of its own.
    received : callable
        Called with the paths of a group when all of it is there.
    refused : callable
        Called with the error when a group is not taken.
    """

    def __init__(
        self,
        folder: Path,
        received: Callable[[list[Path]], None],
        refused: Callable[[CutcellError], None],
    ) -> None:
        self._folder = folder
        self._received = received
        self._refused = refused
        self._paths: list[Path] = []
        self._sizes: list[int] = []
        self._written = 0

    def answer(self, message: dict[str, Any]) -> dict[str, Any] | None:
        """Handle one message; return what to answer, None if it is no concern of ours."""
        act = {
            "upload-begin": self._begin,
            "upload-piece": self._piece,
            "upload-end": self._end,
            "upload-cancel": self._cancel,
        }.get(str(message.get("type")))
        if act is None:
            return None
        try:
            act(message)
        except CutcellError as error:
            self._drop()
            self._refused(error)
            return {"ok": False, "message": str(error)}
        return {"ok": True}

    def _begin(self, message: dict[str, Any]) -> None:
        self._drop()
        files = message["files"]
        if not 0 < len(files) <= MAX_FILES:
            raise FileError(f"{len(files)} files came at once; 1 to {MAX_FILES} can be opened")
        for file in files:
            if not 0 <= int(file["size"]) <= MAX_UPLOAD:
                raise FileError(
                    f'"{file["name"]}" has {file["size"] / 2**20:,.0f} MB; the page takes files '
                    f"of up to {MAX_UPLOAD // 2**20} MB (the cutcell command takes any)"
                )
        folder = Path(tempfile.mkdtemp(dir=self._folder))
        self._paths = [folder / safe_name(file["name"]) for file in files]
        self._sizes = [int(file["size"]) for file in files]
        self._written = 0
        for path in self._paths:
            path.touch()

    def _piece(self, message: dict[str, Any]) -> None:
        index, data = int(message["index"]), bytes(message["data"])
        if not 0 <= index < len(self._paths):
            raise FileError("a piece of a file came that nothing had announced; try again")
        self._written += len(data)
        if self._written > sum(self._sizes):
            raise FileError("more came than was announced; try again")
        with self._paths[index].open("ab") as file:
            file.write(data)

    def _end(self, message: dict[str, Any]) -> None:
        paths, self._paths = self._paths, []
        short = [
            path.name
            for path, size in zip(paths, self._sizes, strict=False)
            if path.stat().st_size != size
        ]
        if short or not paths:
            raise FileError(f'"{", ".join(short)}" did not arrive whole; try again')
        self._received(paths)

    def _cancel(self, message: dict[str, Any]) -> None:
        self._drop()

    def _drop(self) -> None:
        for path in self._paths:
            path.unlink(missing_ok=True)
        self._paths = []


def safe_name(name: str) -> str:
    """Return the last part of a name from the browser, fit to be a file's name here."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    kept = "".join(c for c in last if c.isprintable() and c not in '<>:"|?*').strip(". ")
    return kept[-120:] or "file"


class FileDrop(JSComponent):
    """A place to drop files on, or to choose them with a click."""

    label = param.String("Drop a character here, or choose")
    hint = param.String("")

    _esm = script("upload", "drop")

    def __init__(self, receiver: Receiver, **params: Any) -> None:
        super().__init__(**params)
        self._receiver = receiver

    def _handle_msg(self, data: dict[str, Any]) -> None:
        answer = self._receiver.answer(data)
        if answer is not None:
            self._send_msg({"upload": answer})
