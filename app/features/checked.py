"""Lessons whose addresses are checked as well as their keys."""

from pathlib import Path

from ..document.address import from_query
from .learn.lesson import Lesson, read
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
