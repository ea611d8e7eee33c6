"""Mean value coordinates of closed triangle meshes (Ju, Schaefer & Warren 2005)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cutcell.runtime.compiled import compiled
from cutcell.runtime.threads import in_threads, parts

TOUCHING = 1e-9
"""Angles, and distances of the longest side, below which a point lies on the cage."""


def mean_values(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    points: NDArray[np.float64],
    values: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Carry values from a cage's vertices to points, by their mean value coordinates.

    Shapes: vertices (c, 3), faces (m, 3), points (n, 3), values (c, j); returns (n, j).
    """
    cage = np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.int64)
    points = np.ascontiguousarray(points, np.float64)
    blocks = in_threads(lambda part: _coordinates(*cage, points[part]) @ values, parts(len(points)))
    return np.concatenate(blocks)


@compiled
def _coordinates(vertices, faces, points):
    result = np.zeros((len(points), len(vertices)))
    unit, away = np.empty((len(vertices), 3)), np.empty(len(vertices))
    for p in range(len(points)):
        row = result[p]
        touched = -1
        for v in range(len(vertices)):
            for axis in range(3):
                unit[v, axis] = vertices[v, axis] - points[p, axis]
            away[v] = np.sqrt((unit[v] ** 2).sum())
            if away[v] < TOUCHING:
                touched = v
                break
            unit[v] /= away[v]
        if touched >= 0:
            row[touched] = 1.0
            continue
        for f in range(len(faces)):
            if _add_face(unit, away, faces[f], row):
                break
        row /= row.sum()
    return result


@compiled
def _add_face(unit, away, face, row):
    """Add what a triangle gives to its corners; True if the point lies on it: no other counts."""
    theta, cosine, sine = np.empty(3), np.empty(3), np.empty(3)
    for k in range(3):
        a, b = unit[face[(k + 1) % 3]], unit[face[(k + 2) % 3]]
        theta[k] = 2 * np.arcsin(min(1.0, np.sqrt(((a - b) ** 2).sum()) / 2))
    half = theta.sum() / 2
    if np.pi - half < TOUCHING:
        row[:] = 0
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            row[face[k]] = np.sin(theta[k]) * away[face[a]] * away[face[b]]
        return True
    u, v, w = unit[face[0]], unit[face[1]], unit[face[2]]
    side = np.sign(
        u[0] * (v[1] * w[2] - v[2] * w[1])
        - u[1] * (v[0] * w[2] - v[2] * w[0])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
    )
    for k in range(3):
        a, b = theta[(k + 1) % 3], theta[(k + 2) % 3]
        edges = np.sin(a) * np.sin(b)
        if edges == 0:
            return False  # seen as a line
        cosine[k] = 2 * np.sin(half) * np.sin(half - theta[k]) / edges - 1
        sine[k] = side * np.sqrt(max(0.0, 1 - cosine[k] ** 2))
        if abs(sine[k]) < TOUCHING:
            return False  # seen edge-on
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        row[face[k]] += (theta[k] - cosine[a] * theta[b] - cosine[b] * theta[a]) / (
            away[face[k]] * np.sin(theta[a]) * sine[b]
        )
    return False
