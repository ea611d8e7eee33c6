"""Normals, areas, edges, connected components and closest points of triangles."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .segments import closest_on_segment


def normals(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return normals that are as long as twice the area.

    Shapes: corners (..., 3, 3); returns (..., 3).
    """
    first = corners[..., 0, :]
    return np.cross(corners[..., 1, :] - first, corners[..., 2, :] - first)


def unit_normals(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return normals of length one, shape (..., 3); zero for triangles without area."""
    vectors = normals(corners)
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def areas(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return areas, shape (...), of triangles (..., 3, 3)."""
    return np.asarray(np.linalg.norm(normals(corners), axis=-1) / 2)


def face_edges(faces: NDArray) -> NDArray:
    """Return the three edges of each face, lower vertex first, shape (3 m, 2), with repeats."""
    return np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)


def label_components(faces: NDArray, count: int) -> NDArray[np.int32]:
    """Label the connected components of `count` vertices that faces or edges (m, 3 or 2) join."""
    links = faces[:, :-1].ravel(), faces[:, 1:].ravel()
    graph = coo_array((np.ones(len(links[0]), np.bool_), links), shape=(count, count))
    labels: NDArray[np.int32] = connected_components(graph, directed=False)[1]
    return labels


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
