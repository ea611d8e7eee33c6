"""Names of joints as lists and menus show them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from cutcell.runtime.display import printable

MAX_LETTERS = 36
"""Letters of a joint's name in a list or a menu."""
_SEPARATOR = re.compile(r"[:|_\-. /\]]+")


def without_prefix(names: Sequence[str]) -> list[str]:
    """Return names without what most begin with up to a separator, such as "mixamorig:".

    A name stays whole where nothing readable, or a name that there is already, would be left.
    """
    counts: Counter[str] = Counter()
    for name in set(names):
        counts.update(name[: end.end()] for end in _SEPARATOR.finditer(name))
    shared = [start for start, count in counts.items() if count >= max(3, 0.8 * len(set(names)))]
    prefix = max(shared, key=len, default="")
    rests = [name.removeprefix(prefix) for name in names]
    changed = [rest for rest, name in zip(rests, names, strict=True) if rest != name]
    if not prefix or not all(len(rest) > 1 and rest[0].isalpha() for rest in changed):
        return list(names)
    times = Counter(rests)
    return [rest if times[rest] == 1 else name for name, rest in zip(names, rests, strict=True)]


def middle_cut(name: str, most: int = MAX_LETTERS) -> str:
    """Return a name shortened in its middle: what tells joints apart is often at either end."""
    if len(name) <= most:
        return name
    tail = most // 2
    return f"{name[: most - 1 - tail]}…{name[-tail:]}"


def short_names(names: Sequence[str]) -> list[str]:
    """Return the names of a rig's joints as lists and menus show them, all different if they were.

    Shared prefixes are dropped and long names shortened in the middle.
    """
    rests = [printable(name) for name in without_prefix(names)]
    cut = [middle_cut(rest) for rest in rests]
    times = Counter(cut)
    return [short if times[short] == 1 else rest for short, rest in zip(cut, rests, strict=True)]
