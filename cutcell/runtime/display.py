"""Names and messages as they can be shown: whatever a file calls its joints, meshes and clips.

A name may hold line breaks, control characters that a terminal obeys, or marks that reverse the
direction of writing.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

MAX_LETTERS = 80
"""Longest name that is shown whole."""
MAX_NAMES = 6
"""Largest number of listed names."""
MAX_OF_A_MESSAGE = 2000

_HIDDEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode's categories of control and format characters, lone surrogates, and line ends."""
_JOINERS = "\u200c\u200d"
"""Format characters that some scripts, and composed emoji, are not written without."""

_NOT_PLAIN = re.compile(r"[^\n\x20-\x7e]")


class _Escapes(dict[int, str]):
    """Replacement of each character that occurred."""

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


def listed(names: Sequence[str]) -> str:
    """Return the first of some names, and how many more there are."""
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + more


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


def count(number: int, one: str, verb: str = "") -> str:
    """Return a number with its noun, and a verb if one follows: "1 face is", "3,109 faces are"."""
    noun = one if number == 1 else _MANY.get(one, one + "s")
    if verb and number == 1:
        verb = _ONE.get(verb, verb + "s")
    return f"{number:,} {noun} {verb}".rstrip()


def share(part: float, whole: float) -> str:
    """Return a part of a whole in per cent: "12%", "0.3%", "under 0.1%"."""
    ratio = part / whole if whole > 0 else 0.0
    if 0 < ratio < 0.001:
        return "under 0.1%"
    return f"{ratio:.0%}" if ratio >= 0.1 else f"{ratio:.1%}"


_MANY = {"vertex": "vertices"}
_ONE = {"are": "is", "have": "has", "carry": "carries", "do": "does"}
