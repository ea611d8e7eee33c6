"""The cotangent Laplacian of a triangle mesh, and the area around each vertex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..runtime.compiled import compiled
from .vectors import TIE, between, cross, dot, length, triangle_normal

THINNEST = 1e-4
"""Minimum height of a triangle, as part of its longest side: needles would outweigh all."""


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
    for f in range(len(faces)):
        p, q, r = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
        area = length(triangle_normal(p, q, r)) / 2
        # The cotangent at each corner, and its part of the triangle.
        at_p, at_q, at_r = _cotangent(p, q, r), _cotangent(q, r, p), _cotangent(r, p, q)
        if min(at_p, at_q, at_r) < 0:
            of_p = area / 2 if at_p < 0 else area / 4
            of_q = area / 2 if at_q < 0 else area / 4
            of_r = area / 2 if at_r < 0 else area / 4
        else:  # half of each side's part belongs to either of its ends
            qr, rp, pq = between(q, r), between(r, p), between(p, q)
            by_p, by_q, by_r = at_p * dot(qr, qr), at_q * dot(rp, rp), at_r * dot(pq, pq)
            of_p, of_q, of_r = (by_q + by_r) / 8, (by_r + by_p) / 8, (by_p + by_q) / 8
        total[faces[f, 0]] += of_p
        total[faces[f, 1]] += of_q
        total[faces[f, 2]] += of_r
    return total


@compiled
def vertex_normals(points, faces):
    """Return unit normals, shape (k, 3): averages of faces by area; zero where they cancel out."""
    normals, total = np.zeros((len(points), 3)), np.zeros(len(points))
    for f in range(len(faces)):
        n = triangle_normal(points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]])
        for corner in range(3):
            total[faces[f, corner]] += length(n)
            for axis in range(3):
                normals[faces[f, corner], axis] += n[axis]
    for k in range(len(points)):
        size = length(normals[k])
        for axis in range(3):
            normals[k, axis] = normals[k, axis] / size if size > TIE * total[k] else 0.0
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
            for row, neighbour in ((q, r), (r, q)):
                column[cursor[row]], value[cursor[row]] = neighbour, -half
                value[start[row]] += half
                cursor[row] += 1
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
    pq, pr, qr = between(p, q), between(p, r), between(q, r)
    longest = max(dot(pq, pq), dot(pr, pr), dot(qr, qr))
    # The same for all three corners: then the matrix stays positive for any thin triangle.
    double_area = max(length(cross(pq, pr)), THINNEST * longest)
    return dot(pq, pr) / double_area if longest > 0 else 0.0
