"""Names as files can hold them."""

from __future__ import annotations


def whole_characters(text: str) -> str:
    """Return a text with � in place of each half of a character.

    Characters beyond the first 65,536 are pairs of surrogates in UTF-16 and in JSON's escapes. A
    surrogate alone is no character: UTF-8 cannot hold it, and many readers refuse JSON with it.
    """
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def has_halves(text: str) -> bool:
    """Return whether a text has surrogates without their pair."""
    return not text.isascii() and whole_characters(text) != text


HALVES = "a name in it holds half of a character (a lone surrogate), for which � stands"
"""The warning of a file with such names."""
