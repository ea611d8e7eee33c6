"""Lessons whose addresses are checked as well as their keys."""

from pathlib import Path

from ...document.address import from_query
from ...document.state import State
from .lesson import Lesson, read


def read_checked(path: Path) -> Lesson:
    """Read a lesson, and check that the page has all entries of its addresses.

    Raises
    ------
    FileError
        As `read` does, or an address has an entry that the page does not have.
    """
    state = State()
    return read(path, lambda query: from_query(query, state)[2])
