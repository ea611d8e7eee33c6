"""The cotangent Laplacian of a triangle mesh, and the area around each vertex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

THINNEST = 1e-4
"""Sine of an angle below which a triangle counts as no thinner: needles would outweigh all."""


def cotangent_laplacian(points: NDArray[np.float64], faces: NDArray[np.int32]) -> csr_array:
    """Return the stiffness matrix of linear elements; positive, rows sum to zero.

    Parameters
    ----------
    points : array, shape (k, 3)
    faces : array, shape (m, 3)
        Any triangles; at an edge of more than two all count.

    Returns
    -------
    csr_array, shape (k, k)
        Minus half the cotangents of the angles that face each edge.
    """
    half = _cotangents(points, faces) / 2
    rows, columns, values = [], [], []
    for corner in range(3):
        a, b = faces[:, (corner + 1) % 3], faces[:, (corner + 2) % 3]
        rows += [a, b, a, b]
        columns += [b, a, a, b]
        values += [-half[:, corner], -half[:, corner], half[:, corner], half[:, corner]]
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return coo_array(entries, shape=(len(points),) * 2).tocsr()


def vertex_areas(points: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return each vertex's part of the surface, shape (k,) (mixed areas, Meyer et al. 2003).

    In an acute triangle each corner gets the part that is nearest to it; else the wide
    corner gets half, the others a quarter each.
    """
    corners = points[faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    area /= 2
    cotangent = _cotangents(points, faces)
    opposite = np.stack(
        [((corners[:, (c + 1) % 3] - corners[:, (c + 2) % 3]) ** 2).sum(axis=1) for c in range(3)],
        axis=1,
    )
    voronoi = cotangent * opposite / 8  # at the two ends of each side
    parts = np.roll(voronoi, 1, axis=1) + np.roll(voronoi, -1, axis=1)
    wide = cotangent < 0
    blunt = wide.any(axis=1)
    parts[blunt] = np.where(wide[blunt], area[blunt, None] / 2, area[blunt, None] / 4)
    total = np.zeros(len(points))
    np.add.at(total, faces, parts)
    return total


def vertex_normals(points: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return unit normals, shape (k, 3): the faces' average by area; zero where there is none."""
    corners = points[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.stack(
        [
            np.bincount(faces.ravel(), np.repeat(across[:, axis], 3), minlength=len(points))
            for axis in range(3)
        ],
        axis=1,
    )
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)


def _cotangents(points: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return the cotangent of the angle at each corner, shape (m, 3)."""
    corners = points[faces]
    result = np.empty(faces.shape)
    for corner in range(3):
        a = corners[:, (corner + 1) % 3] - corners[:, corner]
        b = corners[:, (corner + 2) % 3] - corners[:, corner]
        sides = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
        sine = np.maximum(np.linalg.norm(np.cross(a, b), axis=1), THINNEST * sides)
        cosine = (a * b).sum(axis=1)
        result[:, corner] = np.divide(cosine, sine, out=np.zeros(len(a)), where=sine > 0)
    return result
