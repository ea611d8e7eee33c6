"""Closest points of triangles."""

import numpy as np
from numpy.typing import NDArray

from cutcell.geometry.segments import closest_on_segment
from cutcell.geometry.triangles import normals


def closest_on_triangle(
    points: NDArray[np.float64], corners: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the distances of points to triangles, and the shares of corners of closest points.

    Shapes: points (..., 3), corners (..., 3, 3); returns (...) and (..., 3).
    """
    points, normal = np.broadcast_to(points, (*corners.shape[:-2], 3)), normals(corners)
    squared = np.maximum((normal * normal).sum(axis=-1), 1e-300)
    # The share of each corner, of the point's projection, is the part of the area opposite of it.
    turned = [np.stack([points, corners[..., b, :], corners[..., c, :]], axis=-2)
              for b, c in ((1, 2), (2, 0), (0, 1))]  # fmt: skip
    parts = [(normals(part) * normal).sum(axis=-1) / squared for part in turned]
    shares = np.stack(parts, axis=-1)
    gap = np.linalg.norm(points - (shares[..., None] * corners).sum(axis=-2), axis=-1)
    gap = np.where((shares >= 0).all(axis=-1) & (squared > 1e-300), gap, np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        near, part = closest_on_segment(points, corners[..., a, :], corners[..., b, :])
        length = np.linalg.norm(points - near, axis=-1)
        on_edge = np.zeros_like(shares)
        on_edge[..., a], on_edge[..., b] = 1 - part, part
        shares = np.where((length < gap)[..., None], on_edge, shares)
        gap = np.minimum(gap, length)
    return gap, shares
