"""Materials of Wavefront OBJ: the colours of vertices, and what a .mtl file beside it says.

Nothing here stops a mesh from being read: what is wrong is a note.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from ...errors import FileError
from ..files import read_beside
from ..obj import ObjMesh, numbered_words
from .surfaces import ImageFile, Material, Surface, Surfaces

MAX_MTL_BYTES = 2**24
"""Bytes of a .mtl file."""
MAX_LIBRARIES = 64
IMAGE_OPTIONS = {
    **dict.fromkeys(("-o", "-s", "-t"), 3),
    "-mm": 2,
    **dict.fromkeys(("-blendu", "-blendv", "-boost", "-bm", "-cc", "-clamp"), 1),
    **dict.fromkeys(("-colorspace", "-imfchan", "-texres", "-type"), 1),
}
"""Options of images, with the largest number of words that follow."""
NUMBER_OPTIONS = ("-o", "-s", "-t", "-mm")


@dataclass(frozen=True, eq=False)
class ObjSource:
    """The OBJ file that a rig came from; its materials are read when somebody asks, as few do."""

    path: Path  # its .mtl files and images are in its folder
    contents: ObjMesh

    @cached_property
    def surfaces(self) -> Surfaces:
        """The materials of the mesh, and what its corners have."""
        contents, faces = self.contents, self.contents.mesh.faces
        materials, images, notes = _materials(self.path, contents)
        colors = None
        if contents.colors is not None:
            colors = np.round(255 * np.clip(contents.colors, 0, 1)).astype(np.uint8)[faces]
        surface = Surface(faces, contents.material, contents.places, colors, contents.normals)
        return Surfaces(self.path, {0: surface}, materials, images, notes)


def _materials(
    path: Path, contents: ObjMesh
) -> tuple[tuple[Material, ...], tuple[ImageFile, ...], tuple[str, ...]]:
    """Return the materials by the numbers that faces have, their images, and what is missing."""
    by_name: dict[str, Material] = {}
    images: dict[tuple[str, ...], int] = {}
    notes: dict[str, None] = {}
    for label, names in list(_libraries(contents.libraries))[:MAX_LIBRARIES]:
        try:
            text = read_beside(path, names, label, MAX_MTL_BYTES).decode("utf-8", "replace")
        except FileError as error:
            notes[f"the materials of {path.name} are not used: {error}"] = None
            continue
        by_name = {**parse_mtl(text, images), **by_name}
    missing = [name for name in contents.names if name not in by_name]
    if missing and not notes:
        named = ", ".join(f'"{name[:80]}"' for name in missing[:3])
        notes[f"no .mtl file tells of the materials that faces have ({named})"] = None
    used = tuple(by_name.get(name, Material(name)) for name in contents.names)
    return used, tuple(map(ImageFile, images)), tuple(notes)


def _libraries(lines: Iterable[str]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Return what to call each .mtl file, and its names: a line is one name, or some."""
    for line in lines:
        tokens = line.split()
        several = len(tokens) > 1 and all(word.lower().endswith(".mtl") for word in tokens)
        for name in tokens if several else [line]:
            yield f"{name[:80]}", (name,)


def parse_mtl(text: str, images: dict[tuple[str, ...], int]) -> dict[str, Material]:
    """Return the materials of a file by name."""
    described: dict[str, dict[str, list[str]]] = {}
    fields: dict[str, list[str]] = {}
    for _, tokens in numbered_words(text):
        if tokens[0] == "newmtl":
            fields = {}
            described.setdefault(" ".join(tokens[1:]), fields)
        else:
            fields[tokens[0].lower()] = tokens[1:]
    return {name: _material(name, fields, images) for name, fields in described.items()}


def _material(
    name: str, fields: dict[str, list[str]], images: dict[tuple[str, ...], int]
) -> Material:
    color = _numbers(fields.get("kd", []))
    if len(color) == 1:
        color *= 3
    color = color if len(color) == 3 else [1.0] * 3
    opacity = _opacity(fields)
    file = _file(fields.get("map_kd", []))
    if not file:
        return Material(name, tuple(color), opacity=opacity)
    if not any(color):
        color = [1.0] * 3  # some programs write black where there is an image
    image = images.setdefault((file,), len(images))
    return Material(name, tuple(color), image, opacity, blended="map_d" in fields)


def _opacity(fields: dict[str, list[str]]) -> float:
    """Return how opaque a material is; one that is not there at all was meant the other way."""
    dissolve, through = (_numbers(fields.get(key, [])) for key in ("d", "tr"))
    opacity = dissolve[0] if dissolve else 1 - through[0] if through else 1.0
    return opacity if 0 < opacity < 1 else 1.0


def _file(tokens: list[str]) -> str:
    """Return the file of an image, without the options before it."""
    tokens = list(tokens)
    while tokens and tokens[0].lower() in IMAGE_OPTIONS:
        option = tokens.pop(0).lower()
        for _ in range(IMAGE_OPTIONS[option]):
            if not tokens or (option in NUMBER_OPTIONS and not _numbers(tokens[:1])):
                break
            tokens.pop(0)
    return " ".join(tokens)


def _numbers(tokens: list[str]) -> list[float]:
    """Return finite numbers as far as there are any."""
    numbers = []
    for word in tokens[:3]:
        try:
            value = float(word)
        except ValueError:
            break
        if not np.isfinite(value):
            break
        numbers.append(value)
    return numbers
