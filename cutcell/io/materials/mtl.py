"""Wavefront .mtl: the diffuse colours of materials, and their images."""

from __future__ import annotations

import numpy as np

from ..meshes.obj import numbered_words
from .face_colors import CLAMP, REPEAT
from .surfaces import Material

OPTIONS = {
    **dict.fromkeys(("-o", "-s", "-t"), 3),
    "-mm": 2,
    **dict.fromkeys(("-blendu", "-blendv", "-boost", "-bm", "-cc", "-clamp"), 1),
    **dict.fromkeys(("-colorspace", "-imfchan", "-texres", "-type"), 1),
}
"""Of images, with how many words follow at most; numbers may be fewer."""
NUMBERS = ("-o", "-s", "-t", "-mm")


def parse_mtl(text: str, images: dict[tuple[str, ...], int]) -> dict[str, Material]:
    """Return the materials of a file by name."""
    found: dict[str, Material] = {}
    said: dict[str, list[str]] = {}
    name = None
    for _, words in numbered_words(text):
        if words[0] == "newmtl":
            if name is not None:
                found.setdefault(name, _material(name, said, images))
            name, said = " ".join(words[1:]), {}
        else:
            said[words[0].lower()] = words[1:]
    if name is not None:
        found.setdefault(name, _material(name, said, images))
    return found


def _material(
    name: str, said: dict[str, list[str]], images: dict[tuple[str, ...], int]
) -> Material:
    color = _numbers(said.get("kd", []))
    if len(color) == 1:
        color *= 3
    color = color if len(color) == 3 else [1.0] * 3
    opacity = _opacity(said)
    file, clamped = _file(said.get("map_kd", []))
    if not file:
        return Material(name, tuple(color), opacity=opacity)
    if not any(color):
        color = [1.0] * 3  # some programs write black where there is an image
    wrap = 4 * (CLAMP if clamped else REPEAT)
    image = images.setdefault((file,), len(images))
    return Material(name, tuple(color), image, wrap, opacity, blended="map_d" in said)


def _opacity(said: dict[str, list[str]]) -> float:
    """Return how opaque a material is; one that is not there at all was meant the other way."""
    dissolve, through = (_numbers(said.get(key, [])) for key in ("d", "tr"))
    found = dissolve[0] if dissolve else 1 - through[0] if through else 1.0
    return found if 0 < found < 1 else 1.0


def _file(words: list[str]) -> tuple[str, bool]:
    """Return the file of an image, and whether it ends at its border."""
    words, clamped = list(words), False
    while words and words[0].lower() in OPTIONS:
        option = words.pop(0).lower()
        for _ in range(OPTIONS[option]):
            if not words or (option in NUMBERS and not _numbers(words[:1])):
                break
            clamped |= option == "-clamp" and words[0].lower() == "on"
            words.pop(0)
    return " ".join(words), clamped


def _numbers(words: list[str]) -> list[float]:
    """Return finite numbers as far as there are any."""
    found = []
    for word in words[:3]:
        try:
            value = float(word)
        except ValueError:
            break
        if not np.isfinite(value):
            break
        found.append(value)
    return found
