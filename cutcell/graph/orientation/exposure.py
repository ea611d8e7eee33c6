"""Which side of a surface sees the outside, by ray casting (Takayama et al. 2014).

From points on the surface, rays are cast in both directions of lines spread evenly over the sphere.
A ray that hits no other face sees the outside. Rays are cast as in `graph/rays.py`: the mesh is
rotated until the lines are vertical, and hits are decided without tolerances, so no ray passes
between two adjacent faces.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.triangles import areas, unit_normals
from ...runtime.compiled import compiled
from ...runtime.progress import Tell
from ...runtime.threads import in_threads
from ..rays import column_span, height_between

LINES = 12
PATCH_SAMPLES = 2, 32
"""Points on each patch, at least and at most."""
MAX_PATCH_SAMPLES = 4096
"""On all patches together, unless there are more than half as many patches."""
COINCIDENT = 1e-9
"""A face this close to a point does not hide it: it is the other side of a doubled sheet."""
CELLS_EACH = 4
"""Cells for each point, of the grid that finds the points above and below a face."""
SHRINK = 1.75
"""The unit cube, rotated about its middle, fits into itself if scaled down by this."""


def exposure(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    patch: NDArray[np.int32],
    is_measured: NDArray[np.bool_],
    report: Tell = lambda done: None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Measure the share of rays that escape from the front and from the back of patches.

    Shapes: vertices (n, 3), faces (m, 3), patch (m,), is_measured (p,); returns front, back (p,).

    References
    ----------
    Takayama, Jacobson, Kavan & Sorkine-Hornung, "A simple method for correcting facet
    orientations in polygon meshes based on ray casting", 2014.
    """
    count = len(is_measured)
    face, points = _samples(vertices, faces, patch, is_measured)
    normals = unit_normals(vertices[faces[face]])
    of = patch[face]
    # Distinct faces hide as much.
    corners = np.sort(faces, axis=1)
    _, first, index = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    single, own_face = faces[first], index.ravel()[face]

    def along(turn: NDArray[np.float64]) -> NDArray[np.float64]:
        rotated = [_rotated(x, turn) for x in (vertices, points)]
        is_free = _escape(rotated[1], own_face, rotated[0], single)
        cosine = normals @ turn[2]
        weight, is_up = np.abs(cosine), cosine > 0
        front = weight * np.where(is_up, is_free[:, 0], is_free[:, 1])
        back = weight * np.where(is_up, is_free[:, 1], is_free[:, 0])
        return np.stack([np.bincount(of, x, count) for x in (front, back, weight)])

    front, back, every = np.sum(in_threads(along, _turns(), report), axis=0)
    every = np.maximum(every, 1e-300)
    return front / every, back / every


def _rotated(points: NDArray[np.float64], turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotate points (n, 3) in the unit cube; unlike BLAS, every processor rounds this alike."""
    x, y, z = points.T - 0.5
    return np.stack([a * x + b * y + c * z for a, b, c in turn], axis=1) / SHRINK + 0.5


def _turns() -> list[NDArray[np.float64]]:
    """Return rotations (3, 3) that map lines spread over the sphere (a spiral) to the vertical."""
    k = np.arange(LINES) + 0.5
    height, turn = k / LINES, k * np.pi * (3 - np.sqrt(5))
    out = np.sqrt(1 - height**2)
    lines = np.stack([out * np.cos(turn), out * np.sin(turn), height], axis=1)
    turns = []
    for line in lines:
        across = np.cross(line, (0.3, 0.5, 0.81))
        across /= np.linalg.norm(across)
        turns.append(np.stack([across, np.cross(line, across), line]))
    return turns


def _samples(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    patch: NDArray[np.int32],
    is_measured: NDArray[np.bool_],
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Place points evenly by area on patches; return the face and the position of each."""
    selected = np.flatnonzero(is_measured[patch])
    # Sorted by corners: the result depends neither on the order of faces nor on their winding.
    corners = np.sort(faces[selected], axis=1)
    order = np.lexsort((*corners.T[::-1], patch[selected]))
    selected, triangles = selected[order], vertices[corners[order]]
    reached = np.cumsum(areas(triangles))
    first = np.flatnonzero(np.diff(patch[selected], prepend=-1))
    last = np.append(first[1:], len(selected)) - 1
    low = np.concatenate([[0], reached[last[:-1]]])
    each = int(np.clip(MAX_PATCH_SAMPLES // len(first), *PATCH_SAMPLES))
    share = (np.arange(each) + 0.5) / each
    places = low[:, None] + share * (reached[last] - low)[:, None]
    sampled = np.clip(np.searchsorted(reached, places), first[:, None], last[:, None]).ravel()
    # A plane sequence of low discrepancy (Roberts), folded into the triangle.
    k = np.tile(np.arange(each), len(first))
    u, v = 0.7548777 * (k + 1) % 1, 0.5698403 * (k + 1) % 1
    u, v = np.where(u + v > 1, 1 - u, u)[:, None], np.where(u + v > 1, 1 - v, v)[:, None]
    a, b, c = triangles[sampled].transpose(1, 0, 2)
    return selected[sampled], a + u * (b - a) + v * (c - a)


def _escape(
    points: NDArray[np.float64],
    own_face: NDArray[np.intp],
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
) -> NDArray[np.bool_]:
    """Return for each point whether the rays upward and downward escape, shape (p, 2)."""
    is_free, left, face = np.ones((len(points), 2), np.bool_), np.arange(len(points)), 0
    while face < len(faces) and len(left):
        columns = int(np.sqrt(CELLS_EACH * len(left))) + 1
        u, v = (points[left, :2] * columns).astype(np.int64).T
        column = u * columns + v
        left = left[np.argsort(column, kind="stable")]
        start = np.append(0, np.cumsum(np.bincount(column, minlength=columns * columns)))
        free = is_free[left]
        grid = start, columns
        face = _hide(points[left], own_face[left], free, grid, vertices, faces, face)
        is_free[left] = free
        left = left[free.any(axis=1)]
    return is_free


@compiled
def _hide(points, face_of, free, grid, vertices, faces, f):
    """Mark the rays that faces from f on hide; stop where half of the points are hidden.

    In a soup a few faces hide nearly all points. Returns the next face.
    """
    start, columns = grid
    hidden = 0
    while f < len(faces) and 2 * hidden <= len(points):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        low_u = min(vertices[a, 0], vertices[b, 0], vertices[c, 0])
        high_u = max(vertices[a, 0], vertices[b, 0], vertices[c, 0])
        low_v = min(vertices[a, 1], vertices[b, 1], vertices[c, 1])
        high_v = max(vertices[a, 1], vertices[b, 1], vertices[c, 1])
        for i in range(int(low_u * columns), int(high_u * columns) + 1):
            first = start[i * columns + int(low_v * columns)]
            last = start[i * columns + int(high_v * columns) + 1]
            for k in range(first, last):
                pu, pv = points[k, 0], points[k, 1]
                if face_of[k] == f or not (low_u <= pu <= high_u and low_v <= pv <= high_v):
                    continue
                if not (free[k, 0] or free[k, 1]):
                    continue
                span_low, low, span_high, high, _ = column_span(vertices, faces, f, pu)
                if span_low <= pv < span_high:
                    away = height_between(span_low, low, span_high, high, pv) - points[k, 2]
                    if abs(away) > COINCIDENT:
                        free[k, 0 if away > 0 else 1] = False
                        hidden += not (free[k, 0] or free[k, 1])
        f += 1
    return f
