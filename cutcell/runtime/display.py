"""Names and messages as they can be shown: whatever a file calls its joints, meshes and clips.

A name may hold line breaks, control characters that a terminal obeys, marks that turn the
direction of writing around, or the beginning of a spreadsheet's formula.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

MAX_LETTERS = 80
"""Of a name."""
SHORT_LETTERS = 36
"""Of a joint's name in a list or a menu."""
MAX_NAMES = 6
"""Of a list of names."""
MAX_OF_A_MESSAGE = 2000

FORMULA = tuple("=+-@\t\r＝＋－＠")
"""What a spreadsheet takes a cell for a formula by."""

_HIDDEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode's categories of control and format characters, lone surrogates, and line ends."""
_JOINERS = "\u200c\u200d"
"""Format characters that some scripts, and composed emoji, are not written without."""

_SEPARATOR = re.compile(r"[:|_\-. /\]]+")
_NOT_PLAIN = re.compile(r"[^\n\x20-\x7e]")

# A folder that begins at the root, with what follows it up to the last part.
_FOLDERS = re.compile(r"(?<![\w.:/\\])(?:[A-Za-z]:)?[\\/](?:[^\s\\/\"':;,()]+[\\/])+(?=[^\s\\/])")


class _Escapes(dict[int, str]):
    """What stands for each character, as far as it was needed."""

    def __missing__(self, code: int) -> str:
        char = chr(code)
        hidden = unicodedata.category(char) in _HIDDEN and char not in _JOINERS
        self[code] = shown = char.encode("unicode_escape").decode() if hidden else char
        return shown


_ESCAPES = _Escapes()


def printable(text: str, most: int = MAX_OF_A_MESSAGE) -> str:
    r"""Return a text on one line, in which nothing is hidden."""
    if len(text) > most:
        text = text[: most - 1] + "…"
    return text if text.isprintable() else text.translate(_ESCAPES)


def shown_name(name: str) -> str:
    """Return a name as it is shown: printable, and not too long."""
    return printable(name, MAX_LETTERS)


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
    if not prefix or not all(len(rest) > 1 and rest[0].isalpha() for rest in rests):
        return list(names)
    times = Counter(rests)
    return [rest if times[rest] == 1 else name for name, rest in zip(names, rests, strict=True)]


def middle_cut(name: str, most: int = SHORT_LETTERS) -> str:
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


def listed(names: Sequence[str]) -> str:
    """Return the first of some names, and how many more there are."""
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + more


def spreadsheet_cell(name: str) -> str:
    """Return a name as a cell of a table; one that looks like a formula begins with an apostrophe.

    References
    ----------
    OWASP, "CSV Injection".
    """
    shown = printable(name)
    return f"'{shown}" if name.lstrip().startswith(FORMULA) or name.startswith(FORMULA) else shown


def json_safe(text: str) -> str:
    """Return a JSON document in which strings hold no raw control characters either.

    JSON itself only forbids those below a space; the others become escapes, which mean the same.
    """

    def shown(match: re.Match[str]) -> str:
        char = match.group()
        return char if _ESCAPES[ord(char)] == char else json_escape(char)

    return _NOT_PLAIN.sub(shown, text)


def json_escape(text: str) -> str:
    """Return characters as the escapes that strings of JSON have for them."""
    units = text.encode("utf-16-be", "surrogatepass").hex()
    return "".join(f"\\u{units[i : i + 4]}" for i in range(0, len(units), 4))


def without_folders(text: str, known: Iterable[Path] = ()) -> str:
    """Return a message that tells the names of files, and not where they are."""
    for folder in sorted({str(path) for path in known}, key=len, reverse=True):
        if len(folder) > 1:
            inner = r"[\\/](?:[^\s\\/\"':;,()]+[\\/])*"
            text = re.sub(re.escape(folder.rstrip("\\/")) + inner, "", text)
    return _FOLDERS.sub("", text)
