"""Normals and texture coordinates of the corners of a mesh, for new GLB files."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...geometry.triangles import normals as face_normals
from .surfaces import Surface, stored_corners

DECIMALS = 6
"""Decimals of normals, so that rounding errors of a file split no vertices."""


class Corners(NamedTuple):
    """The corners of a mesh."""

    normals: NDArray[np.float32] | None = None  # (m, 3, 3): of length one
    places: NDArray[np.float32] | None = None
    """(m, 3, 2): texture coordinates from the upper left corner of an image."""


Piece: TypeAlias = tuple[Surface, NDArray[np.integer], slice, NDArray[np.float64]]
"""What a file stores of some faces of a mesh: these by the vertices of its surface (k, 3), their
rows in the mesh, and the matrix (4, 4) from the space of the surface."""


def join_corners(vertices: NDArray, faces: NDArray, pieces: Iterable[Piece]) -> Corners:
    """Return the corners of a mesh of pieces; the faces of some may not be their surface's.

    Where a file has no normal, or a normal without a direction, it is that of the smooth surface.
    """
    normals, places = np.zeros((len(faces), 3, 3)), np.zeros((len(faces), 3, 2), np.float32)
    has_normals = has_places = False
    for surface, triangles, rows, matrix in pieces:
        where = stored_corners(surface.faces, triangles)
        if where is None:
            continue
        if surface.places is not None:
            has_places = True
            stored = surface.places.reshape(-1, 2)[where]
            places[rows] = np.nan_to_num(stored, posinf=0, neginf=0)
        if surface.normals is not None:
            has_normals = True
            # Faces of a mirrored mesh are turned on loading, and still face the same side.
            turned = (where[:, 1] - where[:, 0]) % 3 == 2
            turned ^= np.linalg.det(matrix[:3, :3]) < 0
            moved = _moved(surface.normals.reshape(-1, 3)[where], matrix)
            against = np.einsum("ikc,ic->ik", moved, face_normals(vertices[faces[rows]])) < 0
            normals[rows] = np.where((against & turned[:, None])[..., None], -moved, moved)
    complete = _complete(normals, vertices, faces) if has_normals else None
    return Corners(complete, places if has_places else None)


def _moved(normals: NDArray, matrix: NDArray) -> NDArray:
    """Return unit normals in another space, zero for none; (k, 3, 3) and (4, 4) to (k, 3, 3)."""
    unit = _unit(normals.astype(float))
    rows = matrix[:3, :3] / max(np.abs(matrix[:3, :3]).max(), 1e-300)
    if np.array_equal(rows, np.eye(3)):
        return unit
    # The inverse transpose but for a factor: the cofactors, which a singular matrix has, too.
    cofactors = np.cross(rows[[1, 2, 0]], rows[[2, 0, 1]])
    return _unit(unit @ cofactors.T * (-1 if np.linalg.det(rows) < 0 else 1))


def _unit(vectors: NDArray) -> NDArray:
    """Return vectors of length one, zero for those without a direction; (..., 3)."""
    finite = np.where(np.isfinite(vectors).all(axis=-1, keepdims=True), vectors, 0)
    largest = np.abs(finite).max(axis=-1, keepdims=True)
    scaled = finite / np.where(largest > 0, largest, 1)
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return scaled / np.where(length > 0, length, 1)


def _complete(normals: NDArray, vertices: NDArray, faces: NDArray) -> NDArray[np.float32]:
    """Return normals as they are stored; (m, 3, 3), zero for none."""
    missing = (normals == 0).all(axis=2)
    if missing.any():
        normals = np.where(missing[..., None], vertex_normals(vertices, faces)[faces], normals)
    return np.asarray(np.round(normals, DECIMALS) + 0.0, np.float32)  # -0 is 0


def vertex_normals(vertices: NDArray, faces: NDArray) -> NDArray[np.float32]:
    """Return unit normals, shape (n, 3): faces weighted by area, equal positions together."""
    area = face_normals(vertices[faces].astype(float))
    same = np.unique(vertices, axis=0, return_inverse=True)[1].reshape(-1)
    summed = np.zeros((same.max() + 1, 3))
    for k in range(3):
        np.add.at(summed, same[faces[:, k]], area)
    summed /= np.abs(summed).max() or 1.0
    length = np.linalg.norm(summed, axis=1, keepdims=True)
    # Any direction does for a vertex without a face; glTF only asks for unit length.
    unit = np.where(length > 1e-12, summed / np.maximum(length, 1e-12), [0.0, 1.0, 0.0])
    return unit[same].astype(np.float32)
