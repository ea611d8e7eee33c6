"""Elements of ufbx that must never be released: its bindings let go of them too often."""

from __future__ import annotations

KEEP: list[list] = []


def keep(*elements):
    """Let elements stay as long as the process."""
    KEEP.append(list(elements))


def kept(elements):
    """Return a list's elements; they stay as long as the process."""
    KEEP.append(list(elements))
    return KEEP[-1]
