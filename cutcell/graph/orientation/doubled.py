"""Faces that exporters write twice, once from each side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.edges import find_edges
from ...geometry.triangles import normals
from .patches import NONE, find_patches

OPEN_SHEET = 0.5
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
    # Which of two faces comes first says nothing: without the others, patches are oriented alike.
    single = faces.copy()
    single[second] = faces[second, :1]
    areas = normals(vertices[single])
    sizes = np.linalg.norm(areas, axis=1)
    flips, patch, *_ = find_patches(vertices, single, find_edges(single).partner, sizes)
    areas[flips] *= -1
    sums = np.stack([np.bincount(patch, column) for column in areas.T], axis=1)
    is_sheet = np.linalg.norm(sums, axis=1) >= OPEN_SHEET * np.bincount(patch, sizes)
    goes_on = np.ones(len(faces), np.bool_)
    goes_on[first] = goes_on[second] = False
    is_sheet[patch[goes_on]] = False
    is_reversed[second[~is_sheet[patch[first]]]] = True
    return is_reversed
