"""What people are told when something goes wrong: sentences, without the server's folders."""

import errno
import tempfile
from pathlib import Path

from cutcell.errors import CutcellError
from cutcell.runtime.display import printable, without_folders

ROOT = Path(__file__).resolve().parents[2]

FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))
"""What systems say of a disk that has no room, or none for this person."""

KEPT = "The page keeps what it had"


def told(error: BaseException) -> str:
    """Return what went wrong in a sentence.

    Parameters
    ----------
    error : exception
        One that a file or a parameter can cause says it itself; of others it is told what a
        person can make of them.
    """
    if isinstance(error, CutcellError):
        return sentence(shown(str(error)))
    if isinstance(error, MemoryError):
        return (
            "There is not enough memory for this; a lower resolution or a smaller character needs "
            f"less. {KEPT}."
        )
    if isinstance(error, OSError) and error.errno in FULL:
        return f"The server's disk is full. {KEPT}; try again when there is room."
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return (
        f"Something unexpected went wrong ({type(error).__name__}: {shown(reason)}). {KEPT}; the "
        "details are in the server's log."
    )


def shown(text: str) -> str:
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
