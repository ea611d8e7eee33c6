"""Texts of errors: sentences without the server's folders."""

import errno
import os
import re
import tempfile
from collections.abc import Iterable
from pathlib import Path

from cutcell.errors import CutcellError
from cutcell.runtime.display import printable

ROOT = Path(__file__).resolve().parents[2]

FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))
"""Errors of systems for a disk that is full, or full for this user."""

UNCHANGED = "Nothing was changed"

# A folder that begins at the root, with what follows it up to the last part.
_FOLDERS = re.compile(r"(?<![\w.:/\\])(?:[A-Za-z]:)?[\\/](?:[^\s\\/\"':;,()]+[\\/])+(?=[^\s\\/])")


def error_text(error: BaseException) -> str:
    """Return the message of a `CutcellError`, or for other errors one that says how to proceed."""
    if isinstance(error, CutcellError):
        return sentence(visible_text(str(error)))
    if isinstance(error, MemoryError):
        return f"Not enough memory. {UNCHANGED}. Try a lower resolution or a smaller character."
    if isinstance(error, OSError) and error.errno in FULL:
        return f"The server's disk is full. {UNCHANGED}. Try again later."
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return (
        f"Unexpected error ({type(error).__name__}: {visible_text(reason)}). {UNCHANGED}. "
        "Details are in the server's log."
    )


def visible_text(text: str) -> str:
    """Return a message as a page shows it."""
    folders = (Path(tempfile.gettempdir()), Path.cwd(), Path(os.path.expanduser("~")), ROOT)
    return printable(without_folders(text, folders), 600)


def sentence(text: str) -> str:
    """Return a message as a sentence: with a full stop, and a capital if it begins a word."""
    text = text.strip()
    first = text.split(" ", 1)[0]
    if first.isalpha():
        text = text[:1].upper() + text[1:]
    return text + ("" if text.endswith((".", "!", "?")) else ".")


def without_folders(text: str, folders: Iterable[Path] = ()) -> str:
    """Return a message with the names of files, but not their folders."""
    for folder in sorted({str(path) for path in folders}, key=len, reverse=True):
        if len(folder) > 1:
            inner = r"[\\/](?:[^\s\\/\"':;,()]+[\\/])*"
            text = re.sub(re.escape(folder.rstrip("\\/")) + inner, "", text)
    return _FOLDERS.sub("", text)
