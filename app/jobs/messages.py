"""Texts of errors: sentences without the server's folders."""

import errno
import tempfile
from pathlib import Path

from cutcell.errors import CutcellError
from cutcell.runtime.display import printable, without_folders

ROOT = Path(__file__).resolve().parents[2]

FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))
"""Errors of systems for a disk that is full, or full for this user."""

KEPT = "Nothing was changed"


def error_text(error: BaseException) -> str:
    """Return the text of an error.

    Parameters
    ----------
    error : exception
        A `CutcellError` describes itself; other errors get a text that
        says how to proceed.
    """
    if isinstance(error, CutcellError):
        return sentence(visible_text(str(error)))
    if isinstance(error, MemoryError):
        return f"Not enough memory. {KEPT}. Try a lower resolution or a smaller character."
    if isinstance(error, OSError) and error.errno in FULL:
        return f"The server's disk is full. {KEPT}. Try again later."
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return (
        f"Unexpected error ({type(error).__name__}: {visible_text(reason)}). {KEPT}. "
        "Details are in the server's log."
    )


def visible_text(text: str) -> str:
    """Return a message as a page shows it."""
    folders = (Path(tempfile.gettempdir()), Path.cwd(), Path.home(), ROOT)
    return printable(without_folders(text, folders), 600)


def sentence(text: str) -> str:
    """Return a message as a sentence: with a full stop, and a capital if it begins a word."""
    text = text.strip()
    first = text.split(" ", 1)[0]
    if first.isalpha():
        text = text[:1].upper() + text[1:]
    return text + ("" if text.endswith((".", "!", "?")) else ".")
