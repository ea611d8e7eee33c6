"""Vertices that a glTF file stores several times, since a seam runs through them.

One index of glTF is for all that a corner has, so a vertex whose faces have other texture
coordinates or colours is stored once for each. The copies stand behind all other vertices, and the
attribute `_SPLIT_FROM` has the number of the vertex that each was split from. Read again, the mesh
has its own vertices.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...materials.surfaces import stored_corners
from ...weights import ReadWeights
from ..container import Document
from ..read.accessors import read_accessor
from ..read.primitives import StoredFaces, attributes, primitives, read_faces

SPLIT_FROM = "_SPLIT_FROM"
MAX_VERTICES = 2**24
"""As far as float32 counts; glTF allows no 32-bit integers here."""


def split_at_seams(
    faces: NDArray[np.integer], count: int, values: NDArray[np.float32]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Split vertices whose corners have different values.

    Shapes: faces (m, 3), values (m, 3, k); returns faces (m, 3), origin (count + s,).
    """
    corner = faces.reshape(-1).astype(np.intp)
    keys = values.reshape(len(corner), -1)
    order = np.lexsort((*keys.T, corner))
    ordered, at = keys[order], corner[order]
    new = np.ones(len(order), bool)
    new[1:] = (at[1:] != at[:-1]) | (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.empty(len(order), np.intp)
    group[order] = np.cumsum(new) - 1
    first = order[new]  # the sort is stable: the first corner of each group
    vertex = corner[first]
    ranked = np.lexsort((first, vertex))
    leads = np.ones(len(ranked), bool)
    leads[1:] = vertex[ranked][1:] != vertex[ranked][:-1]
    copies = ranked[~leads]
    number = vertex.copy()
    number[copies] = count + np.arange(len(copies))
    return number[group].reshape(-1, 3), np.concatenate([np.arange(count), vertex[copies]])


def read_origin(
    document: Document, primitive: dict[str, Any], positions: NDArray, user: str
) -> NDArray[np.intp] | None:
    """Return which vertex each vertex of a primitive was split from.

    Shapes: positions (n, 3); returns (n,).
    """
    index = attributes(primitive, user).get(SPLIT_FROM)
    if index is None or document.item("accessors", index, user).get("type") != "SCALAR":
        return None
    stored = read_accessor(document, index, "SCALAR", user)[:, 0]
    numbers = np.arange(len(positions))
    if len(stored) != len(numbers) or not (stored <= numbers).all() or (stored < 0).any():
        return None
    origin = stored.astype(np.intp)
    count = int((origin == numbers).sum())
    copies = origin[count:]
    if not len(copies) or (origin != stored).any() or (copies >= count).any():
        return None
    if (origin[:count] != numbers[:count]).any():
        return None
    return origin if np.array_equal(positions, positions[origin]) else None


def merged(
    origin: NDArray[np.intp] | None, read: ReadWeights
) -> tuple[NDArray[np.intp] | None, ReadWeights]:
    """Return weights without those of copies; all of them, and no origin, where copies differ."""
    if origin is None or read.weights is None or read.sums is None:
        return origin, read
    weights, sums = read.weights, read.sums
    count = vertex_count(origin)
    first = origin[count:]
    if not np.array_equal(weights[count:], weights[first]):
        return None, read
    return origin, read._replace(weights=weights[:count].copy(), sums=sums[:count])


def vertex_count(origin: NDArray[np.intp]) -> int:
    """Return how many vertices are no copies."""
    return int((origin == np.arange(len(origin))).sum())


def own_corners(
    document: Document, stored: StoredFaces, faces: NDArray[np.int32]
) -> NDArray[np.int32] | None:
    """Return faces by the numbers that vertices have in a primitive, copies included.

    Shapes: faces (k, 3); returns (k, 3).
    """
    if stored.origin is None:
        return faces
    primitive = primitives(document, stored.mesh, "the document")[stored.primitive]
    found = read_faces(document, primitive, len(stored.origin), "a primitive")
    where = stored_corners(stored.origin[found], faces)
    return None if where is None else found.reshape(-1)[where].astype(np.int32)
