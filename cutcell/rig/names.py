"""Names of joints as they are compared: folded, split into words, without sides."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

SIDES = {"l": "l", "left": "l", "左": "l", "r": "r", "right": "r", "右": "r"}
PREFIX = r"(?<![A-Za-z])(IK|FK|DEF|ORG|MCH|CTRL|CTL)(?=[a-z])"
"""Prefixes in capitals before a word in small letters, as in `IKhand`."""
HUMP = r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])"
"""Where a capital begins a word."""
TOKEN = re.compile(r"[a-z\u00df-\u024f]+|\d+|[^\W\d_a-z\u00df-\u024f]+")
"""A word, a number, or a run of letters of a script that has no capitals."""


def folded(name: str) -> str:
    """Return a name as names are compared: in lower case, without full-width and such forms."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def is_neutral(name: str) -> bool:
    """Return whether a name is that of Blender's stand-in for vertices without weights."""
    return bool(_NEUTRAL.fullmatch(folded(name)))


_NEUTRAL = re.compile(r"neutral_bone([_.]\d+| \(\d+\))?")
"""The joint to which Blender's glTF exporter gives such vertices; several may be numbered."""


def words(name: str) -> list[str]:
    """Split a name into Latin words in lower case: head, top, end of `mixamorig:HeadTop_End_06`."""
    return re.findall(r"[a-z]+", _spaced(name))


def plain(name: str) -> tuple[str, str]:
    """Return words and numbers of a name, and its side: "thumb end 5", "r" of `thumbEnd_R_5`."""
    tokens = TOKEN.findall(_spaced(name))
    sides = [SIDES[token] for token in tokens if token in SIDES]
    tokens = [re.sub("^[左右]", "", token) for token in tokens if token not in SIDES]
    japanese = [SIDES[letter] for letter in re.findall("[左右]", name)]
    return " ".join(tokens), (sides + japanese + [""])[0]


def same_names(names: Sequence[str], others: Sequence[str]) -> NDArray[np.intp]:
    """Return for each name the equal one of others, else the only one alike; -1 for none.

    Names are alike if they have the same words, numbers and side: `ns:Arm_L` and `arm.l`.
    """
    equal = {name: k for k, name in reversed(list(enumerate(others)))}
    alike: dict[tuple[str, str], list[int]] = {}
    for k, name in enumerate(others):
        alike.setdefault(plain(name), []).append(k)
    likely = [alike.get(plain(name), []) for name in names]
    pairs = zip(names, likely, strict=True)
    return np.array([equal.get(n, ks[0] if len(ks) == 1 else -1) for n, ks in pairs], np.intp)


def _spaced(name: str) -> str:
    """Return a name without name spaces, folded, with spaces where words begin."""
    name = re.split(r"[:|]", unicodedata.normalize("NFKC", name))[-1]
    return folded(re.sub(HUMP, " ", re.sub(PREFIX, r"\1 ", name)))
