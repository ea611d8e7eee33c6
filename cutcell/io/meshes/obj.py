"""Wavefront OBJ: every vertex in the file's order, and what faces have at their corners."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import isfinite, nan

import numpy as np
from numpy.typing import NDArray

from ...errors import FileError, MeshError
from ...geometry.polygons import cut_polygons
from ...rig import TriangleMesh

MOST = 2**31 - 2
"""Number of a vertex, counted from 0."""
KINDS = ("v", "vt", "vn")
"""References of a corner of a face, in this order."""


@dataclass(frozen=True, eq=False)
class ObjMesh:
    """The contents of an OBJ, by triangle where they are the faces'."""

    mesh: TriangleMesh
    places: NDArray[np.float32] | None
    """(m, 3, 2): texture coordinates of corners, from the upper left corner of an image; those of 0
    0 for corners without any."""
    normals: NDArray[np.float32] | None  # (m, 3, 3): as they are stored; NaN for none
    colors: NDArray[np.float64] | None  # (n, 3): of vertices, from 0 to 1
    material: NDArray[np.int32]  # (m,): positions in `names`, -1 for none
    names: tuple[str, ...]  # the materials and their files
    libraries: tuple[str, ...]  # the materials and their files


@dataclass
class _Lines:
    """The lines of an OBJ: by corner `corners`, by face `counts`, `sizes`, `lines`, `materials`."""

    vertices: list[list[float]] = field(default_factory=list)
    places: list[tuple[float, float]] = field(default_factory=list)
    normals: list[tuple[float, ...]] = field(default_factory=list)
    colors: list[list[float]] = field(default_factory=list)
    corners: list[tuple[int, int, int]] = field(default_factory=list)
    counts: list[tuple[int, int, int]] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    materials: list[int] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    libraries: list[str] = field(default_factory=list)


def parse_obj(text: str) -> ObjMesh:
    """Read vertices and faces; polygons are cut into triangles."""
    read = _read(text)
    if not read.vertices:
        raise MeshError("has no vertices (no lines that start with v)")
    vertices = np.array(read.vertices)
    at = _numbered(read)
    outside = np.flatnonzero(at[:, 0] >= len(vertices))
    if len(outside):
        line = np.repeat(read.lines, read.sizes)[outside[0]]
        raise MeshError(
            f"line {line}: vertex {at[outside[0], 0] + 1} is out of range; "
            f"the file has only {len(vertices)}"
        )
    triangles, polygons = cut_polygons(vertices, at[:, 0], np.array(read.sizes, int))
    mesh = TriangleMesh(vertices, at[:, 0][triangles])
    places = _of_corners(read.places, at[:, 1][triangles], (0, 1))
    normals = _of_corners(read.normals, at[:, 2][triangles], (nan, nan, nan))
    colors = np.array(read.colors) if len(read.colors) == len(vertices) else None
    material = np.array(read.materials, np.int32)[polygons]
    names, libraries = tuple(read.names), tuple(dict.fromkeys(read.libraries))
    return ObjMesh(mesh, places, normals, colors, material, names, libraries)


def write_obj(mesh: TriangleMesh) -> str:
    """Return a mesh as OBJ text, positions to the last bit."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist()]
    return "\n".join(lines) + "\n"


def numbered_words(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the words of each line that is neither empty nor a comment.

    A line that ends with a backslash goes on in the next one.
    """
    first, tokens = 0, list[str]()
    for number, line in enumerate([*text.splitlines(), ""], start=1):
        first = first if tokens else number
        tokens += line.removesuffix("\\").split()
        if tokens and not tokens[0].startswith("#"):
            if line.endswith("\\"):
                continue
            yield first, tokens
        tokens = []


def numbers(tokens: list[str], count: int, line: int) -> list[float]:
    """Return exactly `count` finite numbers."""
    values = [one_number(word, line) for word in tokens]
    if len(values) != count:
        raise FileError(f"line {line}: {len(values)} numbers, expected {count}")
    if not np.isfinite(values).all():
        raise FileError(f"line {line}: {' '.join(tokens)[:80]} is not finite")
    return values


def one_number(word: str, line: int) -> float:
    """Return a number, which need not be finite."""
    try:
        return float(word)
    except ValueError:
        raise FileError(f'line {line}: "{word[:40]}" is not a number') from None


def _read(text: str) -> _Lines:
    read, material = _Lines(), -1
    parsed: dict[str, tuple[int, int, int]] = {}
    for number, tokens in numbered_words(text):
        kind = tokens[0]
        if kind == "v":
            read.vertices.append(numbers(tokens[1:4], 3, number))
            if len(tokens) in (7, 8):
                read.colors.append([_lenient(word, 0.0) for word in tokens[4:7]])
        elif kind == "vt":
            u, v, *_ = [*tokens[1:3], "0", "0"]  # the second may be missing
            read.places.append((_lenient(u, 0.0), 1 - _lenient(v, 0.0)))
        elif kind == "vn":
            read.normals.append(tuple(_lenient(w, nan) for w in [*tokens[1:4], "", "", ""][:3]))
        elif kind == "f":
            if len(tokens) < 4:
                raise FileError(f"line {number}: a face needs at least 3 corners")
            for word in tokens[1:]:
                if word not in parsed:
                    parsed[word] = _corner(word, number)
                read.corners.append(parsed[word])
            read.counts.append((len(read.vertices), len(read.places), len(read.normals)))
            read.sizes.append(len(tokens) - 1)
            read.lines.append(number)
            read.materials.append(material)
        elif kind == "usemtl":
            material = read.names.setdefault(" ".join(tokens[1:]), len(read.names))
        elif kind == "mtllib":
            read.libraries.append(" ".join(tokens[1:]))
    return read


def _corner(word: str, line: int) -> tuple[int, int, int]:
    """Return the numbers of a corner as the file has them, 0 for none."""
    parts = [*word.split("/"), "", ""]
    try:
        vertex = int(parts[0])
    except ValueError:
        raise FileError(f'line {line}: "{word[:40]}" is not a corner of a face') from None
    if vertex > MOST + 1:
        raise FileError(f"line {line}: vertex {word[:40]} is out of range")
    return max(vertex, -MOST), _index(parts[1]), _index(parts[2])


def _index(word: str) -> int:
    try:
        index = int(word)
    except ValueError:
        return 0
    return index if abs(index) <= MOST else 0


def _numbered(read: _Lines) -> NDArray[np.int64]:
    """Return what corners refer to, counted from 0; negative for none, shape (k, 3)."""
    stored = np.array(read.corners, np.int64).reshape(-1, 3)
    before = np.repeat(np.array(read.counts, np.int64).reshape(-1, 3), read.sizes, axis=0)
    at = np.where(stored > 0, stored - 1, np.where(stored < 0, before + stored, -1))
    bad = np.flatnonzero(at[:, 0] < 0)
    if len(bad):
        line = np.repeat(read.lines, read.sizes)[bad[0]]
        raise FileError(f"line {line}: vertex {stored[bad[0], 0]} is out of range; they start at 1")
    return at


def _of_corners(values: list, at: NDArray, otherwise: tuple) -> NDArray[np.float32] | None:
    """Return values of corners, (m, 3) to (m, 3, width); None if no corner has any."""
    is_stored = (at >= 0) & (at < len(values))
    if not is_stored.any():
        return None
    stored = np.array([*values, otherwise], float)
    with np.errstate(over="ignore"):  # what becomes infinite counts as none
        return stored[np.where(is_stored, at, -1)].astype(np.float32)


def _lenient(word: str, otherwise: float) -> float:
    try:
        value = float(word)
    except ValueError:
        return otherwise
    return value if isfinite(value) else otherwise
