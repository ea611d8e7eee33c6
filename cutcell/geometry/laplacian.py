"""The cotangent Laplacian of a triangle mesh, and the area around each vertex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..runtime.compiled import compiled

THINNEST = 1e-4
"""Height of a triangle, as part of its longest side, below which it counts as no thinner: needles
would outweigh all."""


def cotangent_laplacian(points: NDArray[np.float64], faces: NDArray[np.int32]) -> csr_array:
    """Return the stiffness matrix of linear elements; positive, rows sum to zero.

    Shapes: points (k, 3), faces (m, 3); returns (k, k).
    """
    start, column, value = stiffness(points, faces)
    matrix = csr_array((value, column, start), shape=(len(points),) * 2)
    matrix.sort_indices()
    return matrix


@compiled
def vertex_areas(points, faces):
    """Return each vertex's part of the surface, shape (k,) (mixed areas, Meyer et al. 2003).

    In an acute triangle each corner gets the part that is nearest to it; else the wide
    corner gets half, the others a quarter each.
    """
    total = np.zeros(len(points))
    _add_areas(points, faces, total)
    return total


@compiled
def vertex_normals(points, faces):
    """Return unit normals, shape (k, 3): the faces' average by area; zero where there is none."""
    normals = np.zeros((len(points), 3))
    _add_normals(points, faces, normals)
    for k in range(len(points)):
        x, y, z = normals[k, 0], normals[k, 1], normals[k, 2]
        length = np.sqrt(x * x + y * y + z * z)
        if length > 0:
            normals[k, 0], normals[k, 1], normals[k, 2] = x / length, y / length, z / length
    return normals


@compiled
def stiffness(points, faces):
    """Return rows of `cotangent_laplacian`: where they begin, columns (their own first), values."""
    count = len(points)
    start = np.ones(count + 1, np.int32)
    start[0] = 0
    for f in range(len(faces)):
        for corner in range(3):
            start[faces[f, corner] + 1] += 2
    start = np.cumsum(start).astype(np.int32)
    column, value = np.empty(start[-1], np.int32), np.empty(start[-1])
    # The diagonal comes first in each row, then both other corners of each face.
    cursor = start[:-1] + 1
    for k in range(count):
        column[start[k]], value[start[k]] = k, 0.0
    for f in range(len(faces)):
        for corner in range(3):
            p, q, r = faces[f, corner], faces[f, (corner + 1) % 3], faces[f, (corner + 2) % 3]
            half = _cotangent(points[p], points[q], points[r]) / 2
            for here, there in ((q, r), (r, q)):
                column[cursor[here]], value[cursor[here]] = there, -half
                value[start[here]] += half
                cursor[here] += 1
    return _merge(start, column, value)


@compiled
def _merge(start, column, value):
    """Add up the entries of one row and column."""
    entry = np.full(len(start) - 1, -1)
    end, first = 0, 0
    for row in range(len(start) - 1):
        begin, last = end, start[row + 1]
        for e in range(first, last):
            if entry[column[e]] >= begin:
                value[entry[column[e]]] += value[e]
            else:
                entry[column[e]] = end
                column[end], value[end] = column[e], value[e]
                end += 1
        start[row + 1], first = end, last
    return start, column[:end], value[:end]


@compiled
def _cotangent(p, q, r):
    """Return the cotangent of the angle at p; zero where two corners coincide."""
    ax, ay, az = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    bx, by, bz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    cx, cy, cz = bx - ax, by - ay, bz - az
    longest = max(
        ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, cx * cx + cy * cy + cz * cz
    )
    # The same for all three corners: then the matrix stays positive for any thin triangle.
    double_area = max(np.sqrt(x * x + y * y + z * z), THINNEST * longest)
    return (ax * bx + ay * by + az * bz) / double_area if longest > 0 else 0.0


@compiled
def _across(p, q, r):
    ax, ay, az = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    bx, by, bz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@compiled
def _add_normals(points, faces, normals):
    for f in range(len(faces)):
        x, y, z = _across(points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]])
        for corner in range(3):
            normals[faces[f, corner], 0] += x
            normals[faces[f, corner], 1] += y
            normals[faces[f, corner], 2] += z


@compiled
def _add_areas(points, faces, total):
    for f in range(len(faces)):
        p, q, r = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
        x, y, z = _across(p, q, r)
        area = np.sqrt(x * x + y * y + z * z) / 2
        # The cotangent at each corner, and its part of the triangle.
        at_p, at_q, at_r = _cotangent(p, q, r), _cotangent(q, r, p), _cotangent(r, p, q)
        if min(at_p, at_q, at_r) < 0:
            of_p = area / 2 if at_p < 0 else area / 4
            of_q = area / 2 if at_q < 0 else area / 4
            of_r = area / 2 if at_r < 0 else area / 4
        else:  # half of each side's part belongs to either of its ends
            by_p, by_q, by_r = at_p * _apart(q, r), at_q * _apart(r, p), at_r * _apart(p, q)
            of_p, of_q, of_r = (by_q + by_r) / 8, (by_r + by_p) / 8, (by_p + by_q) / 8
        total[faces[f, 0]] += of_p
        total[faces[f, 1]] += of_q
        total[faces[f, 2]] += of_r


@compiled
def _apart(p, q):
    """Return the squared distance of two points."""
    x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return x * x + y * y + z * z
