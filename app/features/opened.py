"""What a server opens for its pages: a lesson, or an audit of pairs."""

from pathlib import Path

from cutcell_lab.dataset import load_audit

from ..document.address import from_query
from .learn.lesson import Lesson, read
from .pairs.choices import OpenedAudit
from .state import PageState


def read_checked(path: Path) -> Lesson:
    """Read a lesson, and check that the page has all entries of its addresses.

    Raises
    ------
    FileError
        As `read` does, or an address has an entry that the page does not have.
    """
    state = PageState()
    return read(path, lambda query: from_query(query, state)[2])


def open_audit(folder: Path) -> OpenedAudit:
    """Read an audit whose pairs are reviewed."""
    return OpenedAudit(folder, load_audit(folder))
