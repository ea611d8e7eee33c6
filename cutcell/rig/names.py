"""Comparison of names, and those of joints that are none."""

from __future__ import annotations

import re
import unicodedata


def folded(name: str) -> str:
    """Return a name in the form in which names are compared.

    Compatibility forms, such as full-width Latin and half-width katakana, become the usual ones,
    marks join their letters, and upper case becomes lower case.
    """
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def is_neutral(name: str) -> bool:
    """Return whether a name is that of Blender's stand-in for vertices without weights."""
    return bool(_NEUTRAL.fullmatch(folded(name)))


_NEUTRAL = re.compile(r"neutral_bone([_.]\d+| \(\d+\))?")
"""The joint to which Blender's glTF exporter gives such vertices; several may be numbered."""
