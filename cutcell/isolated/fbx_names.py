"""Elements of an FBX and their names, which old programs did not write in UTF-8.

ufbx' bindings let go of list elements too often: each list is walked once and kept.
"""

from __future__ import annotations

import math
import re

import ufbx

ENCODINGS = {
    "cp932": (rb"[\x82\x83].|[\x88-\x97].", 3100),
    "gbk": (rb"[\xb0-\xd7][\xa1-\xfe]", 3755),
    "cp949": (rb"[\xb0-\xc8][\xa1-\xfe]", 2350),
    "big5": (rb"[\xa4-\xc6].", 5401),
    "cp1251": (rb"(?<=[\xc0-\xff])[\xc0-\xff]|[\xc0-\xff](?=[\xc0-\xff])", 64),
    "cp1252": (rb"(?<=[A-Za-z])[\xc0-\xff]|[\xc0-\xff](?=[A-Za-z])", 64),
}
"""Bytes of usual characters by encoding, and how many of these there are."""
UNUSUAL = 1e6
KEEP: list[list] = []
"""Elements of ufbx that must never be released: its bindings let go of them too often."""
NAMES: dict[int, str] = {}
"""Names that are not UTF-8, by the numbers of their elements."""


def kept(elements):
    """Return a list's elements; they stay as long as the process."""
    KEEP.append(list(elements))
    return KEEP[-1]


def label(element):
    """Return the name of an element."""
    return NAMES.get(element.element_id, element.name)


def read_names(elements):
    """Read the names that are not UTF-8; return what to say of them."""
    NAMES.clear()
    raw = {one.element_id: _stored(one) for one in elements if "\ufffd" in one.name}
    if not raw:
        return []
    encoding = guessed(raw.values())
    NAMES.update((k, name.decode(encoding, "replace")) for k, name in raw.items())
    return [
        f"its names are not UTF-8. They are read as {encoding}, guessed from their letters; if "
        "they are wrong, save the file again with a newer program"
    ]


def _stored(element):
    """Return the name of an element as the file, read with `retain_dom`, has it."""
    values = kept(kept([element.dom_node])[0].values)
    stored = next(v.value_blob for v in values if v.type == ufbx.DomValueType.STRING)
    name, mark, _ = stored.partition(b"\0\1")
    return name if mark else stored.split(b"::", 1)[-1]


def guessed(names):
    """Return the encoding in which names, as bytes, are most likely."""
    raw = b" ".join(names)

    def surprise(encoding):
        try:
            text = raw.decode(encoding)
        except UnicodeDecodeError:
            return math.inf
        usual, count = ENCODINGS[encoding]
        matches = len(re.findall(usual, raw, re.DOTALL))
        others = max(sum(not letter.isascii() for letter in text) - matches, 0)
        return matches * math.log(count) + others * math.log(UNUSUAL)

    return min(ENCODINGS, key=surprise)


def decoded(name):
    """Return the text of a name that stands alone, in UTF-8 or an encoding that is guessed."""
    try:
        return name.decode()
    except UnicodeDecodeError:
        return name.decode(guessed([name]), "replace")
