"""Wavefront OBJ: every vertex in the file's order, and what faces have at their corners."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError, MeshError
from ..geometry.polygons import cut_polygons
from ..rig import TriangleMesh

MAX_VERTEX_NUMBER = 2**31 - 2
"""Number of a vertex, counted from 0."""
OBJ_KEYWORDS = ("v", "vt", "vn", "f", "usemtl", "mtllib")
"""Lines that are read."""
FORMS = {"": (0,), "/N": (0, 1), "//N": (0, 2), "/N/N": (0, 1, 2)}
"""Corners of faces after their vertex, and what they refer to: vertex, place, normal."""


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
    names: tuple[str, ...]  # of the materials
    libraries: tuple[str, ...]  # files of materials


@dataclass(frozen=True, eq=False)
class _Lines:
    """The lines of one kind: their numbers in the file, and their text, which begins with it."""

    at: list[int]
    text: list[str]


def parse_obj(text: str) -> ObjMesh:
    """Read vertices and faces; polygons are cut into triangles."""
    lines = {kind: _Lines([], []) for kind in OBJ_KEYWORDS}
    for number, line in numbered_lines(text):
        kind = line.partition(" ")[0]
        if kind not in lines:
            kind = next(iter(line.split(None, 1)), "")  # behind a blank, or before a tab
        if kind in lines:
            lines[kind].at.append(number)
            lines[kind].text.append(line)
    vertices, faces = _vertices(lines["v"]), lines["f"]
    sizes = np.array([len(face.split()) - 1 for face in faces.text], int)
    if len(sizes) and sizes.min() < 3:
        raise FileError(f"line {faces.at[sizes.argmin()]}: a face needs at least 3 corners")
    at = _numbered(lines, sizes, len(vertices))
    triangles, polygons = cut_polygons(vertices, at[:, 0], sizes)
    mesh = TriangleMesh(vertices, at[:, 0][triangles])
    places = _lenient(lines["vt"].text, 2, 0.0)
    places[:, 1] = 1 - places[:, 1]
    names = [" ".join(line.split()[1:]) for line in lines["usemtl"].text]
    materials = {name: k for k, name in enumerate(dict.fromkeys(names))}
    used = np.array([-1, *(materials[name] for name in names)], np.int32)
    libraries = (" ".join(line.split()[1:]) for line in lines["mtllib"].text)
    return ObjMesh(
        mesh,
        _of_corners(places, at[:, 1][triangles], (0.0, 1.0)),
        _of_corners(_lenient(lines["vn"].text, 3, nan), at[:, 2][triangles], (nan, nan, nan)),
        _colors(lines["v"].text),
        used[_before(lines["usemtl"], faces)][polygons],
        tuple(materials),
        tuple(dict.fromkeys(libraries)),
    )


def write_obj(mesh: TriangleMesh) -> str:
    """Return a mesh as OBJ text, positions to the last bit."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist()]
    return "\n".join(lines) + "\n"


def numbered_lines(text: str) -> Iterator[tuple[int, str]]:
    """Return the number and the text of each line; one that ends with a backslash goes on."""
    lines = enumerate(text.splitlines(), start=1)
    return _continued(lines) if "\\" in text else lines


def _continued(lines: Iterator[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    first, begun = 0, ""
    for number, line in lines:
        if begun:
            line = f"{begun} {line}"
        else:
            first = number
        begun = ""
        if line.endswith("\\") and not line.lstrip().startswith("#"):
            begun = line[:-1] or " "
        else:
            yield first, line
    if begun:
        yield first, begun


def numbered_words(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the words of each line that is neither empty nor a comment."""
    for number, line in numbered_lines(text):
        words = line.split()
        if words and not words[0].startswith("#"):
            yield number, words


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


def _table(text: list[str], first: int, width: int) -> NDArray[np.float64] | None:
    """Return the numbers in some words of lines (k, width), None if a line lacks one of them."""
    if not text:
        return np.zeros((0, width))
    try:
        return np.loadtxt(text, usecols=range(first, first + width), ndmin=2, comments=None)
    except ValueError:
        return None


def _vertices(lines: _Lines) -> NDArray[np.float64]:
    if not lines.text:
        raise MeshError("has no vertices (no lines that start with v)")
    table = _table(lines.text, 1, 3)
    if table is not None and np.isfinite(table).all():
        return table
    pairs = zip(lines.at, lines.text, strict=True)  # which names the line that is wrong
    return np.array([numbers(line.split()[1:4], 3, number) for number, line in pairs])


def _lenient(text: list[str], width: int, missing: float, first: int = 1) -> NDArray[np.float64]:
    """Return the numbers in some words of lines (k, width), `missing` for what is none."""
    table = _table(text, first, width)
    if table is None:
        rows = [[*line.split()[first:], *[""] * width][:width] for line in text]
        table = np.array([[_number(word) for word in row] for row in rows])
    return np.where(np.isfinite(table), table, missing)


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return nan


def _colors(vertices: list[str]) -> NDArray[np.float64] | None:
    """Return the colours of vertices, if each has one after its position and perhaps its weight."""
    if any(len(line.split()) not in (7, 8) for line in vertices):
        return None
    return _lenient(vertices, 3, 0.0, first=4)


def _before(lines: _Lines, faces: _Lines) -> NDArray[np.intp]:
    """Return how many lines are before each face."""
    return np.searchsorted(lines.at, faces.at)


def _numbered(lines: dict[str, _Lines], sizes: NDArray, count: int) -> NDArray[np.int64]:
    """Return what corners refer to, counted from 0; negative for none, shape (k, 3)."""
    faces, stored = lines["f"], _corners(lines["f"])
    at = stored - (stored > 0)
    at[stored == 0] = -1
    if (stored < 0).any():
        before = np.stack([_before(lines[kind], faces) for kind in OBJ_KEYWORDS[:3]], axis=1)
        at = np.where(stored < 0, np.repeat(before, sizes, axis=0) + stored, at)
    bad = np.flatnonzero((at[:, 0] < 0) | (at[:, 0] >= count))
    if len(bad):
        line, vertex = np.repeat(faces.at, sizes)[bad[0]], stored[bad[0], 0]
        if vertex <= 0:
            raise FileError(f"line {line}: vertex {vertex} is out of range; they start at 1")
        raise MeshError(f"line {line}: vertex {vertex} is out of range; the file has only {count}")
    return at


def _corners(faces: _Lines) -> NDArray[np.int64]:
    """Return the numbers of corners as the file has them, 0 for none, shape (k, 3)."""
    text = " ".join(line.partition("f")[2] for line in faces.text).lstrip()
    first = text.split(None, 1)[0] if text else ""
    for form, columns in FORMS.items():
        pattern = f"-?[0-9]{{1,9}}{form.replace('N', '-?[0-9]{1,9}')}"
        # Nearly all files have one form, without numbers that are too long.
        if re.fullmatch(pattern, first) and re.fullmatch(rf"(?:{pattern}(?:\s+|\Z))*+", text):
            numbers = np.fromstring(text.replace("/", " "), np.int64, sep=" ")
            corners = np.zeros((len(numbers) // len(columns), 3), np.int64)
            corners[:, columns] = numbers.reshape(-1, len(columns))
            return corners
    parsed: dict[str, tuple[int, int, int]] = {}
    rows = []
    for line, face in zip(faces.at, faces.text, strict=True):
        for word in face.split()[1:]:
            if word not in parsed:
                parsed[word] = _corner(word, line)
            rows.append(parsed[word])
    return np.array(rows, np.int64).reshape(-1, 3)


def _corner(word: str, line: int) -> tuple[int, int, int]:
    parts = [*word.split("/"), "", ""]
    try:
        vertex = int(parts[0])
    except ValueError:
        raise FileError(f'line {line}: "{word[:40]}" is not a corner of a face') from None
    if vertex > MAX_VERTEX_NUMBER + 1:
        raise FileError(f"line {line}: vertex {word[:40]} is out of range")
    return max(vertex, -MAX_VERTEX_NUMBER), _index(parts[1]), _index(parts[2])


def _index(word: str) -> int:
    try:
        index = int(word)
    except ValueError:
        return 0
    return index if abs(index) <= MAX_VERTEX_NUMBER else 0


def _of_corners(
    values: NDArray, at: NDArray, missing: tuple[float, ...]
) -> NDArray[np.float32] | None:
    """Return values of corners, (m, 3) to (m, 3, width); None if no corner has any."""
    is_stored = (at >= 0) & (at < len(values))
    if not is_stored.any():
        return None
    stored = np.concatenate([values, [missing]])
    with np.errstate(over="ignore"):  # what becomes infinite counts as none
        return stored[np.where(is_stored, at, -1)].astype(np.float32)
