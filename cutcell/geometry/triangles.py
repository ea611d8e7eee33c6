"""Normals and areas of triangles, by the positions of their corners."""

import numpy as np
from numpy.typing import NDArray


def normals(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return normals that are as long as twice the area.

    Shapes: corners (..., 3, 3); returns (..., 3).
    """
    first = corners[..., 0, :]
    return np.cross(corners[..., 1, :] - first, corners[..., 2, :] - first)


def unit_normals(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return normals of length one, shape (..., 3); zero for triangles without area."""
    found = normals(corners)
    return found / np.maximum(np.linalg.norm(found, axis=-1, keepdims=True), 1e-300)


def areas(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return areas, shape (...), of triangles (..., 3, 3)."""
    found: NDArray[np.float64] = np.linalg.norm(normals(corners), axis=-1) / 2
    return found
