"""Wavefront OBJ, positions and faces only: every vertex kept, in the file's order."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ...errors import FileError, MeshError
from ...rig import TriangleMesh

MOST = 2**31 - 2
"""Number of a vertex, counted from 0."""


def parse_obj(text: str) -> TriangleMesh:
    """Read vertices and faces; polygons are cut into fans of triangles.

    Texture coordinates, normals, groups and materials are passed over; `ColouredObj` reads what
    colours the faces.
    """
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    for number, tokens in numbered_words(text):
        if tokens[0] == "v":
            vertices.append(numbers(tokens[1:4], 3, number))
        elif tokens[0] == "f":
            corners = [_corner(word, len(vertices), number) for word in tokens[1:]]
            if len(corners) < 3:
                raise FileError(f"line {number}: a face needs at least 3 corners")
            faces += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
    if not vertices:
        raise MeshError("has no vertices (no lines that start with v)")
    return TriangleMesh(np.array(vertices), np.array(faces, int))  # type: ignore[arg-type]


def write_obj(mesh: TriangleMesh) -> str:
    """Return a mesh as OBJ text, positions to the last bit."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist()]
    return "\n".join(lines) + "\n"


def numbered_words(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the words of each line that is neither empty nor a comment."""
    for number, line in enumerate(text.splitlines(), start=1):
        tokens = line.split()
        if tokens and not tokens[0].startswith("#"):
            yield number, tokens


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


def _corner(word: str, count: int, line: int) -> int:
    try:
        index = int(word.split("/")[0])
    except ValueError:
        raise FileError(f'line {line}: "{word[:40]}" is not a corner of a face') from None
    at = index - 1 if index > 0 else count + index
    if index == 0 or at < 0:
        raise FileError(f"line {line}: vertex {index} is out of range; they start at 1")
    if at > MOST:
        raise FileError(f"line {line}: vertex {word[:40]} is out of range")
    return at
