"""The cotangent Laplacian of a triangle mesh, and the area around each vertex."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

THINNEST = 1e-4
"""Height of a triangle, as part of its longest side, below which it counts as no thinner: needles
would outweigh all."""


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
    total = np.zeros(len(points))
    _add_areas(points, faces, total)
    return total


def vertex_normals(points: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return unit normals, shape (k, 3): the faces' average by area; zero where there is none."""
    normals = np.zeros((len(points), 3))
    _add_normals(points, faces, normals)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)


def _cotangents(points: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return the cotangent of the angle at each corner, shape (m, 3)."""
    result = np.empty(faces.shape)
    _fill_cotangents(points, faces, result)
    return result


@njit(cache=True, nogil=True)
def _fill_cotangents(points, faces, result):
    for f in range(len(faces)):
        for corner in range(3):
            p = points[faces[f, corner]]
            result[f, corner] = _cotangent(
                p, points[faces[f, (corner + 1) % 3]], points[faces[f, (corner + 2) % 3]]
            )


@njit(cache=True, nogil=True)
def _cotangent(p, q, r):
    """Return the cotangent of the angle at p; zero where two corners are at one place."""
    ax, ay, az = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    bx, by, bz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    cx, cy, cz = bx - ax, by - ay, bz - az
    longest = max(
        ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, cx * cx + cy * cy + cz * cz
    )
    # The same for all three corners: then no triangle, however thin, conducts uphill.
    double_area = max(np.sqrt(x * x + y * y + z * z), THINNEST * longest)
    return (ax * bx + ay * by + az * bz) / double_area if longest > 0 else 0.0


@njit(cache=True, nogil=True)
def _across(p, q, r):
    ax, ay, az = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    bx, by, bz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@njit(cache=True, nogil=True)
def _add_normals(points, faces, normals):
    for f in range(len(faces)):
        x, y, z = _across(points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]])
        for corner in range(3):
            normals[faces[f, corner], 0] += x
            normals[faces[f, corner], 1] += y
            normals[faces[f, corner], 2] += z


@njit(cache=True, nogil=True)
def _add_areas(points, faces, total):
    cotangent, opposite = np.empty(3), np.empty(3)
    for f in range(len(faces)):
        x, y, z = _across(points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]])
        area = np.sqrt(x * x + y * y + z * z) / 2
        for corner in range(3):
            p = points[faces[f, corner]]
            q, r = points[faces[f, (corner + 1) % 3]], points[faces[f, (corner + 2) % 3]]
            cotangent[corner] = _cotangent(p, q, r)
            opposite[corner] = ((q - r) ** 2).sum()
        for corner in range(3):
            if cotangent.min() < 0:
                part = area / 2 if cotangent[corner] < 0 else area / 4
            else:  # half of each side's part belongs to either of its ends
                i, j = (corner + 1) % 3, (corner + 2) % 3
                part = (cotangent[i] * opposite[i] + cotangent[j] * opposite[j]) / 8
            total[faces[f, corner]] += part
