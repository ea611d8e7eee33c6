"""Materials of Wavefront OBJ: the colours of vertices, and what a .mtl file beside it says.

Nothing here stops a mesh from being read: what is wrong is a note.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from math import isfinite
from pathlib import Path

import numpy as np

from ...errors import FileError
from ...rig import TriangleMesh
from ..files import read_beside, read_text
from ..meshes.obj import numbered_words
from .surfaces import ImageFile, Material, Surface, Surfaces

LARGEST = 2**24
"""Bytes of a .mtl file."""
MAX_LIBRARIES = 64
COLOURED = re.compile(r"^[ \t]*(usemtl[ \t]|v([ \t]+\S+){6,7}[ \t]*\r?$)", re.MULTILINE)
OPTIONS = {
    **dict.fromkeys(("-o", "-s", "-t"), 3),
    "-mm": 2,
    **dict.fromkeys(("-blendu", "-blendv", "-boost", "-bm", "-cc", "-clamp"), 1),
    **dict.fromkeys(("-colorspace", "-imfchan", "-texres", "-type"), 1),
}
"""Of images, with how many words follow at most; numbers may be fewer."""
NUMBERS = ("-o", "-s", "-t", "-mm")


@dataclass(frozen=True, eq=False)
class ColouredObj:
    """An OBJ with materials or colours; they are read when somebody asks, as few do.

    Parameters
    ----------
    path : Path
        Its .mtl files and images are in its folder.
    mesh : TriangleMesh
        As `parse_obj` reads it.
    """

    path: Path
    mesh: TriangleMesh

    @classmethod
    def of(cls, path: Path, text: str, mesh: TriangleMesh) -> ColouredObj | None:
        """Return it; None where `text` names no materials and gives vertices no colours."""
        return cls(path, mesh) if COLOURED.search(text) else None

    @cached_property
    def surfaces(self) -> Surfaces:
        """The materials of the mesh; empty if the file was removed."""
        try:
            return _surfaces(self.path, read_text(self.path), self.mesh)
        except FileError:
            return Surfaces(self.path, {})


def _surfaces(path: Path, text: str, mesh: TriangleMesh) -> Surfaces:
    contents = _read(text)
    materials, images, notes = _materials(path, contents)
    count = len(mesh.faces)
    uv = np.array(contents.places, float).reshape(-1, 2)
    at = np.array(contents.corners, int).reshape(-1, 3)
    places = None
    if len(at) == count and (is_valid := (at >= 0) & (at < len(uv))).any():
        uv_of_corners = np.where(is_valid[..., None], uv[np.where(is_valid, at, 0)], 0)
        places = np.stack([uv_of_corners[..., 0], 1 - uv_of_corners[..., 1]], axis=2).astype(
            np.float32
        )
    colors = None
    if len(contents.colors) == len(mesh.vertices):
        values = np.clip(np.nan_to_num(np.array(contents.colors)), 0, 1)
        colors = np.round(255 * values).astype(np.uint8)[mesh.faces]
    material = np.full(count, -1, np.int32)
    if len(contents.materials) == count:
        material[:] = contents.materials
    surface = Surface(mesh.faces, material, places, colors)
    return Surfaces(path, {0: surface}, materials, images, notes)


@dataclass
class _Said:
    """The contents of an OBJ; of each triangle, in the order of `parse_obj`."""

    libraries: list[str] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    places: list[tuple[float, float]] = field(default_factory=list)
    colors: list[list[float]] = field(default_factory=list)
    corners: list[tuple[int, int, int]] = field(default_factory=list)
    materials: list[int] = field(default_factory=list)


def _read(text: str) -> _Said:
    contents, material = _Said(), -1
    for _, tokens in numbered_words(text):
        kind = tokens[0]
        if kind == "f":
            at = [_place(word, len(contents.places)) for word in tokens[1:]]
            fan = [(at[0], b, c) for b, c in pairwise(at[1:])]
            contents.corners += fan
            contents.materials += [material] * len(fan)
        elif kind == "vt":
            u, v, *_ = [*tokens[1:3], "0", "0"]  # the second may be missing
            contents.places.append((_number(u), _number(v)))
        elif kind == "v" and len(tokens) in (7, 8):
            contents.colors.append([_number(word) for word in tokens[4:7]])
        elif kind == "usemtl":
            material = contents.names.setdefault(" ".join(tokens[1:]), len(contents.names))
        elif kind == "mtllib":
            contents.libraries.append(" ".join(tokens[1:]))
    return contents


def _place(word: str, count: int) -> int:
    """Return which texture coordinates a corner names, counted from 0; -1 for none."""
    parts = word.split("/")
    try:
        index = int(parts[1])
    except (IndexError, ValueError):
        return -1
    at = index - 1 if index > 0 else count + index
    return at if 0 <= at < 2**31 and index else -1


def _number(word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        return 0.0
    return value if isfinite(value) else 0.0


def _materials(
    path: Path, contents: _Said
) -> tuple[tuple[Material, ...], tuple[ImageFile, ...], tuple[str, ...]]:
    """Return the materials by the numbers that faces have, their images, and what is missing."""
    by_name: dict[str, Material] = {}
    images: dict[tuple[str, ...], int] = {}
    notes: dict[str, None] = {}
    for label, names in list(_libraries(contents.libraries))[:MAX_LIBRARIES]:
        try:
            text = read_beside(path, names, label, LARGEST).decode("utf-8", "replace")
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


def _libraries(lines: list[str]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Return what to call each .mtl file, and its names: a line is one name, or some."""
    for line in dict.fromkeys(lines):
        tokens = line.split()
        several = len(tokens) > 1 and all(word.lower().endswith(".mtl") for word in tokens)
        for name in tokens if several else [line]:
            yield f"{name[:80]}", (name,)


def parse_mtl(text: str, images: dict[tuple[str, ...], int]) -> dict[str, Material]:
    """Return the materials of a file by name."""
    materials: dict[str, Material] = {}
    fields: dict[str, list[str]] = {}
    name = None
    for _, tokens in numbered_words(text):
        if tokens[0] == "newmtl":
            if name is not None:
                materials.setdefault(name, _material(name, fields, images))
            name, fields = " ".join(tokens[1:]), {}
        else:
            fields[tokens[0].lower()] = tokens[1:]
    if name is not None:
        materials.setdefault(name, _material(name, fields, images))
    return materials


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
    while tokens and tokens[0].lower() in OPTIONS:
        option = tokens.pop(0).lower()
        for _ in range(OPTIONS[option]):
            if not tokens or (option in NUMBERS and not _numbers(tokens[:1])):
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
