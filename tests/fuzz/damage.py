"""Ways to damage a file: of its numbers, words, lines, bytes, and of a tree of JSON."""

from __future__ import annotations

import copy
import re
import struct
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.random import Generator

ODD_BYTES = [
    struct.pack(form, value)
    for form, values in (
        ("<B", (0, 1, 127, 128, 255)),
        ("<H", (0, 255, 32768, 65535)),
        ("<I", (0, 1, 2**16, 2**31 - 1, 2**31, 2**32 - 1)),
        ("<Q", (0, 2**31, 2**32, 2**63 - 1, 2**63, 2**64 - 1)),
        ("<f", (0.0, -1.0, 1e-38, 3e38, float("inf"), float("nan"))),
        ("<d", (0.0, -1.0, 1e-308, 1.7e308, float("inf"), float("nan"))),
    )
    for value in values
]
ODD_WORDS = [
    "0", "-1", "1", "2", "7", "65535", "2147483647", "2147483648", "-2147483649", "4294967296",
    "99999999999999999999", "9" * 5000, "1e308", "-1e308", "1e-320", "1e400", "nan", "inf", "-inf",
    "0.5", "1/2/3", "1//", "-", "", "x", "x" * 3000, "\u0663", "\u00b2", "\ud7ff", "\0", "#", '"',
    "{", "}", "[", "]", "(", ")", ",", "true", "null", "root", "v", "f", "end_header",
]  # fmt: skip
ODD_JSON: list[Any] = [
    None, True, False, -1, 0, 1, 2, 3, 4, 5, 7, 12, 255, 5120, 5121, 5123, 5125, 5126, 2**31, 2**32,
    10**9, 10**18, 10**30, 0.5, -0.5, 1e-300, 1e38, 1e300, "", "x", "x" * 3000, "SCALAR", "VEC3",
    "VEC4", "MAT4", "STEP", "CUBICSPLINE", "matrix", "weights", "scale", "rotation", "\ud800",
    "\x1b[31m", "../../etc/passwd", "data:;base64,AAAA", "a\nb", [], [0], [0, 1], [None], [[]],
    [0] * 16, [1e300] * 16, [0] * 4, [1e38] * 3, [1e-300] * 3, list(range(50)), {}, {"a": 1},
    {"node": 0}, {"bufferView": 0},
]  # fmt: skip

MAX_PLACES = 5000
"""Of a tree that is damaged once more."""


def tree(rng: Generator, document: Any) -> Any:
    """Damage a tree of JSON at one to four places."""
    document = copy.deepcopy(document)
    for _ in range(_few(rng)):
        places = list(_places(document))
        if not 0 < len(places) < MAX_PLACES:  # nothing, or what grew by thousands already
            break
        owner, key = places[rng.integers(len(places))]
        _change(rng, owner, key, places)
    return document


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    keys = value if isinstance(value, dict) else range(len(value))
    for key in list(keys):
        yield value, key
        if isinstance(value[key], dict | list):
            yield from _places(value[key])


def _change(rng: Generator, owner: Any, key: Any, places: list[tuple[Any, Any]]) -> None:
    old = owner[key]
    way = rng.integers(8)
    if way == 0:
        del owner[key]
    elif way == 1:
        other, there = places[rng.integers(len(places))]
        owner[key] = copy.deepcopy(other[there])
    elif way == 2 and isinstance(owner, list):
        owner += [copy.deepcopy(old)] * int(rng.choice([1, 3, 100, 3000]))
    elif way == 3 and isinstance(owner, dict):
        owner[str(rng.choice(["x" * 3000, "", *owner]))] = old
    elif way in (4, 5) and type(old) in (int, float):
        owner[key] = _other_number(rng, old)
    else:
        owner[key] = copy.deepcopy(ODD_JSON[rng.integers(len(ODD_JSON))])


def _other_number(rng: Generator, old: float) -> float:
    ways: list[Callable[[], float]] = [
        lambda: old + 1,
        lambda: old - 1,
        lambda: -old,
        lambda: old * 2,
        lambda: old * 10**6,
        lambda: old // 2,
        lambda: old + int(rng.integers(-10, 10)),
        lambda: old * 1e30,
    ]
    return ways[rng.integers(len(ways))]()


def lines(rng: Generator, content: bytes) -> bytes:
    """Damage a text: its words, its lines, now and then its bytes."""
    if rng.random() < 0.1:
        return raw(rng, content)
    parts = content.decode("utf-8", "surrogateescape").split("\n")
    for _ in range(_few(rng)):
        k = int(rng.integers(len(parts)))
        way = rng.integers(6)
        if way == 0:
            del parts[k]
        elif way == 1:
            parts[k:k] = [parts[rng.integers(len(parts))]] * int(rng.choice([1, 2, 500]))
        elif way == 2:
            other = rng.integers(len(parts))
            parts[k], parts[other] = parts[other], parts[k]
        else:
            parts[k] = _other_words(rng, parts[k])
        parts = parts or [""]
    return "\n".join(parts).encode("utf-8", "surrogateescape")


def _other_words(rng: Generator, line: str) -> str:
    words = re.split(r"([\s,()\[\]{}\"=:]+)", line)
    k = int(rng.integers(0, (len(words) + 1) // 2)) * 2
    way = rng.integers(4)
    if way == 0:
        del words[k : k + 2]
    elif way == 1:
        words[k:k] = [words[k], " "] * int(rng.choice([1, 2, 300]))
    else:
        words[k] = ODD_WORDS[rng.integers(len(ODD_WORDS))]
    return "".join(words)


def raw(rng: Generator, content: bytes) -> bytes:
    """Damage bytes: some flipped, numbers replaced, parts cut out, doubled or moved."""
    found = bytearray(content)
    for _ in range(_few(rng)):
        if not found:
            break
        at = int(rng.integers(len(found)))
        if rng.random() < 0.4:  # where headers are
            at = int(rng.integers(min(len(found), 200)))
        length = int(rng.integers(1, 40))
        way = rng.integers(7)
        if way == 0:
            found[at] ^= 1 << int(rng.integers(8))
        elif way in (1, 2):
            odd = ODD_BYTES[rng.integers(len(ODD_BYTES))]
            found[at : at + len(odd)] = odd
        elif way == 3:
            del found[at : at + length]
        elif way == 4:
            found[at:at] = found[at : at + length] * int(rng.choice([1, 2, 100]))
        elif way == 5:
            other = int(rng.integers(len(found)))
            found[at : at + length] = found[other : other + length]
        elif rng.random() < 0.5:
            del found[at:]
    return bytes(found)


def numbers(rng: Generator, array: np.ndarray) -> np.ndarray:
    """Damage an array: its values, its type, or its shape."""
    way = rng.integers(6)
    if way == 0:
        return _other_kind(rng, array)
    if way == 1:
        return array[: rng.integers(0, max(len(array), 1))] if array.ndim else array.reshape(1)
    if way == 2:
        return array.reshape(-1) if rng.random() < 0.5 else array[None]
    if way == 3:
        shapes = [(0,), (0, 3), (), (3, 0), (1, 3), (2, 2, 2), (100_000, 3), (5,)]
        return np.zeros(shapes[rng.integers(len(shapes))], array.dtype)
    array = array.copy()
    if array.dtype.kind in "US" or not array.size:
        return array[..., None]
    odd = [0, -1, 1, 2, 100, 2**31, 2**62, np.nan, np.inf, -np.inf, 1e308, 1e-308, 1e39]
    with np.errstate(all="ignore"):
        value = np.array(odd[rng.integers(len(odd))]).astype(array.dtype)
    array[tuple(int(rng.integers(n)) for n in array.shape)] = value
    if way == 4:
        array[...] = value
    return array


def _other_kind(rng: Generator, array: np.ndarray) -> np.ndarray:
    if array.dtype.kind in "US":
        return array.astype("S")
    kinds = ["f2", "f4", "f8", "i1", "u1", "u8", "i8", "c16", "b1", "U3", "S2", "M8[s]", ">f8"]
    with np.errstate(all="ignore"):
        return array.astype(kinds[rng.integers(len(kinds))], casting="unsafe")


def _few(rng: Generator) -> int:
    return int(rng.choice([1, 1, 1, 2, 2, 3, 4, 8]))
