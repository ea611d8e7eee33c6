"""Self-intersections: a grid of cells finds faces that are near, and pairs of these are tested.

Faces that share a vertex are not compared. The number of tested pairs is bounded; beyond it the
result is a lower bound.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geometry.vectors import between, cross, dot, triangle_normal
from ..runtime.compiled import compiled
from .finding import Finding, finding_of
from .subject import Subject

MAX_TESTS = 5_000_000
GRID_SIDE = 64
"""Along the longest side."""
MAX_ENTRIES = 40
"""Average number of cells per face: with more, the cells are enlarged."""


def find_intersections(subject: Subject) -> Iterator[Finding]:
    """Look for faces that pass through others."""
    is_crossed, is_whole = intersecting_faces(subject.mesh.points, subject.faces)
    crossed = subject.whole[is_crossed]
    least, part = "" if is_whole else "At least ", subject.area_share(crossed)
    yield from finding_of("self-intersections", faces=crossed, least=least, part=part)


def intersecting_faces(
    points: NDArray[np.float64], faces: NDArray[np.int32]
) -> tuple[NDArray[np.bool_], bool]:
    """Return which faces pass through another that they share no vertex with.

    Shapes: points (k, 3), faces (w, 3); returns (w,).
    """
    corners = points[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    cells = int(np.clip(np.sqrt(len(faces) / 6), 1, GRID_SIDE))
    while True:
        first, last = (np.clip((x * cells).astype(np.int64), 0, cells - 1) for x in (low, high))
        if cells == 1 or (last - first + 1).prod(axis=1).sum() <= MAX_ENTRIES * len(faces):
            break
        cells //= 2
    is_crossed, is_whole = _cross(points, faces, low, high, first, last, cells, MAX_TESTS)
    return is_crossed, bool(is_whole)


@compiled
def _cross(points, faces, low, high, first, last, cells, most):
    start = np.zeros(cells**3 + 1, np.int64)
    for f in range(len(faces)):
        for x in range(first[f, 0], last[f, 0] + 1):
            for y in range(first[f, 1], last[f, 1] + 1):
                for z in range(first[f, 2], last[f, 2] + 1):
                    start[(x * cells + y) * cells + z + 1] += 1
    start = np.cumsum(start)
    cursor, listed = start[:-1].copy(), np.empty(start[-1], np.int32)
    for f in range(len(faces)):
        for x in range(first[f, 0], last[f, 0] + 1):
            for y in range(first[f, 1], last[f, 1] + 1):
                for z in range(first[f, 2], last[f, 2] + 1):
                    cell = (x * cells + y) * cells + z
                    listed[cursor[cell]] = f
                    cursor[cell] += 1

    is_crossed, tests = np.zeros(len(faces), np.bool_), 0
    for cell in range(cells**3):
        for i in range(start[cell], start[cell + 1]):
            f = listed[i]
            for j in range(i + 1, start[cell + 1]):
                g = listed[j]
                if is_crossed[f] and is_crossed[g]:
                    continue
                if not _boxes_meet(low, high, f, g) or _share_a_vertex(faces, f, g):
                    continue
                tests += 1
                if tests > most:
                    return is_crossed, False
                if _pierces(points, faces, f, g) or _pierces(points, faces, g, f):
                    is_crossed[f] = is_crossed[g] = True
    return is_crossed, True


@compiled(inline="always")
def _boxes_meet(low, high, f, g):
    for axis in range(3):
        if low[f, axis] > high[g, axis] or low[g, axis] > high[f, axis]:
            return False
    return True


@compiled(inline="always")
def _share_a_vertex(faces, f, g):
    for i in range(3):
        for j in range(3):
            if faces[f, i] == faces[g, j]:
                return True
    return False


@compiled
def _pierces(points, faces, f, g):
    """Return whether a side of face f passes through the inside of face g."""
    a, b, c = points[faces[g, 0]], points[faces[g, 1]], points[faces[g, 2]]
    normal = triangle_normal(a, b, c)
    heights = (
        dot(normal, between(a, points[faces[f, 0]])),
        dot(normal, between(a, points[faces[f, 1]])),
        dot(normal, between(a, points[faces[f, 2]])),
    )
    for k in range(3):
        if heights[k] * heights[(k + 1) % 3] >= 0:
            continue  # touching is no intersection
        p, q = points[faces[f, k]], points[faces[f, (k + 1) % 3]]
        way = between(p, q)
        pa, pb, pc = between(p, a), between(p, b), between(p, c)
        u = dot(way, cross(pb, pc))
        v = dot(way, cross(pc, pa))
        w = dot(way, cross(pa, pb))
        if (u > 0 and v > 0 and w > 0) or (u < 0 and v < 0 and w < 0):
            return True
    return False
