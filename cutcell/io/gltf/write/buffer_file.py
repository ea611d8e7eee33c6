"""Where a ``.gltf`` keeps its buffer: a file beside it that is nobody else's."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Collection
from itertools import count
from pathlib import Path
from typing import Any
from urllib.parse import quote

from ..container import Document, beside

UNFIT = re.compile(r"[\x00-\x1f\x7f:\\\ud800-\udfff]")
"""Characters of file names that a relative URI cannot contain, or `beside` refuses."""


def buffer_file(path: Path, source: Document, reserved: Collection[Path] = ()) -> Path:
    """Return the file for the buffer of a document: NAME.bin, or NAME-2.bin and so on.

    A file that is there is replaced only if it is the buffer of the document that is replaced.
    One that the rig was read from is replaced only if its document is.
    """
    replaceable = _buffers_of(path)
    if os.path.realpath(path) != os.path.realpath(source.path):
        replaceable -= {os.path.realpath(file) for file in _files_of(source.path, source.json)}
    stem = UNFIT.sub("_", path.stem)
    for k in count(1):
        choice = path.with_name(f"{stem}.bin" if k == 1 else f"{stem}-{k}.bin")
        free = not os.path.lexists(choice) and choice not in reserved
        if free or os.path.realpath(choice) in replaceable:
            return choice
    raise AssertionError("count ends")


def relative_uri(file: Path) -> str:
    """Return the URI by which a document names a file beside it; letters stay as they are."""
    return "".join(c if ord(c) > 127 else quote(c, safe="!$&'()*+,;=@") for c in file.name)


def _buffers_of(path: Path) -> set[str]:
    """Return the real paths of the buffers of a document, if there is a readable one."""
    try:
        document = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return set()
    return {os.path.realpath(file) for file in _files_of(path, document, ("buffers",))}


def _files_of(
    path: Path, document: Any, kinds: Collection[str] = ("buffers", "images")
) -> list[Path]:
    """Return the files beside a document that it refers to."""
    files: list[Path | None] = []
    for kind in kinds:
        objects = document.get(kind) if isinstance(document, dict) else None
        for item in objects if isinstance(objects, list) else ():
            uri = item.get("uri") if isinstance(item, dict) else None
            if isinstance(uri, str) and not uri.startswith("data:"):
                files.append(beside(path, uri))
    return [file for file in files if file is not None]
