"""Texts and names as the sidebar shows them."""

import re
from collections import Counter
from collections.abc import Sequence

from cutcell.rig import Rig
from cutcell.runtime.display import printable, shown_name
from cutcell_viewers.short_names import short_names


def as_text(text: str) -> str:
    """Return a text that Panel shows as it stands: it takes texts for Markdown, and so for HTML.

    Names of joints in a file could otherwise contain a script.
    """
    return _PUNCTUATION.sub(lambda match: f"&#{ord(match.group())};", printable(text or ""))


_PUNCTUATION = re.compile(r"[!-&(-+\-/<-@\[-`{-~]|[.:](?=\S)|(?<=\d)\.")
"""All but what ends sentences and their parts; an address, for one, would become a link."""


def unique_names(names: Sequence[str]) -> list[str]:
    """Return names to be shown, of which none comes twice: the second gets "(2)" added."""
    unique: dict[str, None] = {}
    numbers: Counter[str] = Counter()
    for name in map(shown_name, names):
        numbered = name
        while numbered in unique:
            numbers[name] += 1
            numbered = f"{name} ({numbers[name] + 1})"
        unique[numbered] = None
    return list(unique)


def joint_title(rig: Rig, joint: int) -> str:
    """Return a joint's name as the page shows it."""
    return short_names(rig.skeleton.names)[joint]
