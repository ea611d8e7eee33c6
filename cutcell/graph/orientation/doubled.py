"""Faces that exporters write twice, once from each side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.edges import find_edges
from ...geometry.triangles import label_components, normals
from .patches import NONE

OPEN = 0.5
"""Faces are a sheet, which encloses nothing, if their area vectors sum to this share of the area.
The area of the caps of their holes is no less."""


def find_reversed(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], partner: NDArray[np.int32]
) -> NDArray[np.bool_]:
    """Find the faces that repeat an earlier one the other way round, except those of sheets.

    A sheet keeps both sides, whose winding numbers cancel, and so does a wall between two bodies,
    unless a surface goes on beyond it.

    Shapes: vertices (n, 3), faces (m, 3), partner (3 m,), see `find_edges`; returns (m,).
    """
    is_reversed = np.zeros(len(faces), np.bool_)
    # Such a face has no manifold edge with any but its copy.
    beside = partner.reshape(-1, 3) // 3
    alone = (beside == NONE) | (beside == beside.max(axis=1, keepdims=True))
    alone[:, 0] &= (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    chosen = np.flatnonzero(alone.all(axis=1))
    corners = np.sort(faces[chosen], axis=1)
    _, which, uses = np.unique(corners, axis=0, return_inverse=True, return_counts=True)
    which = which.ravel()
    a, b, c = faces[chosen].T
    is_even = (a < b) ^ (b < c) ^ (c < a)
    is_pair = (uses == 2) & (np.bincount(which, is_even, len(uses)) == 1)
    order = np.argsort(which, kind="stable")
    if not is_pair.any():
        return is_reversed
    first, second = chosen[order[is_pair[which[order]]]].reshape(-1, 2).T
    patch = label_components(faces[first], len(vertices))[faces[first, 0]]
    areas = normals(vertices[faces[first]])
    total = np.bincount(patch, np.linalg.norm(areas, axis=1))
    sums = np.stack([np.bincount(patch, column) for column in areas.T], axis=1)
    is_sheet = np.linalg.norm(sums, axis=1) >= OPEN * total
    single, is_single = faces.copy(), np.ones(len(faces) + 1, np.bool_)
    single[second], is_single[first], is_single[NONE] = faces[second, :1], False, False
    goes_on = is_single[find_edges(single).partner.reshape(-1, 3)[first] // 3].any(axis=1)
    is_sheet[patch[goes_on]] = False
    is_reversed[second[~is_sheet[patch]]] = True
    return is_reversed
