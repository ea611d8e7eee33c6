"""Normals, areas, edges and connected components of triangles."""

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled, inlined


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
    """Label the connected components of `count` vertices that faces or edges (m, 3 or 2) join.

    Labels follow the order of the components' first vertices.
    """
    return _label_components(faces.astype(np.int64), count)


@compiled
def _label_components(faces, count):
    first = np.arange(count)
    for face in faces:
        for k in range(1, len(face)):
            a, b = first_of_set(first, face[k - 1]), first_of_set(first, face[k])
            first[max(a, b)] = min(a, b)
    label, labels = np.empty(count, np.int32), 0
    for i in range(count):
        if first[i] == i:
            label[i] = labels
            labels += 1
        else:  # those before are labelled
            label[i] = label[first[i]]
    return label


@inlined
def first_of_set(first, i):
    """Return the first member of the set of i (disjoint sets, Tarjan 1975).

    Each entry of `first` is a member of the same set, no later; the way is halved.
    """
    while first[i] != i:
        first[i] = first[first[i]]
        i = first[i]
    return i
