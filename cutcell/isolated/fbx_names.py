"""Elements of an FBX and their names, which old programs did not write in UTF-8."""

from __future__ import annotations

import math
import re

import ufbx

USUAL = {
    "cp932": (rb"[\x82\x83].|[\x88-\x97].", 3100),
    "gbk": (rb"[\xb0-\xd7][\xa1-\xfe]", 3755),
    "cp949": (rb"[\xb0-\xc8][\xa1-\xfe]", 2350),
    "big5": (rb"[\xa4-\xc6].", 5401),
    "cp1251": (rb"(?<=[\xc0-\xff])[\xc0-\xff]|[\xc0-\xff](?=[\xc0-\xff])", 64),
    "cp1252": (rb"(?<=[A-Za-z])[\xc0-\xff]|[\xc0-\xff](?=[A-Za-z])", 64),
}
"""Bytes of usual characters by encoding, and how many of these there are."""
CLASS = re.compile(rb"\x00\x01.*|^(Model|Geometry|Material|AnimStack)::", re.DOTALL)
KEEP: list[list] = []
NAMES_BY_ELEMENT: dict[int, str] = {}
"""Names that are not UTF-8, by the numbers of their elements."""


def retain(elements):
    """Return a list's elements; ufbx' bindings let go of them too often, so they stay for good."""
    KEEP.append(list(elements))
    return KEEP[-1]


def label(element):
    """Return the name of an element."""
    return NAMES_BY_ELEMENT.get(element.element_id, element.name)


def read_names(elements):
    """Read the names that are not UTF-8, with `retain_dom`; return what to say of them."""
    NAMES_BY_ELEMENT.clear()
    raw = {}
    for one in elements:
        if "\ufffd" in one.name:  # for what ufbx writes such bytes
            values = retain(retain([one.dom_node])[0].values)
            name = next(v.value_blob for v in values if v.type == ufbx.DomValueType.STRING)
            raw[one.element_id] = CLASS.sub(b"", name)
    if not raw:
        return []
    encoding = guessed(b" ".join(raw.values()))
    NAMES_BY_ELEMENT.update((k, name.decode(encoding, "replace")) for k, name in raw.items())
    return [
        f"its names are not UTF-8. They are read as {encoding}, guessed from their letters; if "
        "they are wrong, save the file again with a newer program"
    ]


def guessed(raw):
    """Return the encoding in which bytes are most likely."""

    def surprise(encoding):
        usual, count = USUAL[encoding]
        text, times = raw.decode(encoding, "replace"), len(re.findall(usual, raw, re.DOTALL))
        others = max(sum(not letter.isascii() for letter in text) - times, 0)
        return times * math.log(count) + 14 * others + 99 * text.count("\ufffd")

    return min(USUAL, key=surprise)
