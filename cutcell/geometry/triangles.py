"""Normals, areas, edges and connected components of triangles."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


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
