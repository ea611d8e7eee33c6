"""Diagonals of the lattice cells that lie inside, for paths that need not follow the axes."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

CORNERS = np.array(list(itertools.product((0, 1), repeat=3)))


def cell_diagonals(
    whole: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]], resolution: int
) -> NDArray[np.int64]:
    """Return the face and body diagonals of cells whose twelve edges all lie inside.

    Parameters
    ----------
    whole : three arrays of int64
        For x, y, z: sorted lattice numbers ((x R) + y) R + z from which the edge to the
        next point along that axis is kept and not crossed.
    resolution : int
        R.

    Returns
    -------
    array, shape (d, 2), int64
        Lattice numbers of the ends; each diagonal once.
    """
    strides = np.array([resolution**2, resolution, 1])
    cells = whole[0]
    for axis, kept in enumerate(whole):
        for corner in CORNERS[CORNERS[:, axis] == 0]:
            cells = cells[_contains(kept, cells + corner @ strides)]
    number = CORNERS @ strides
    pairs = [
        (a, b)
        for a, b in itertools.combinations(range(8), 2)
        if np.abs(CORNERS[a] - CORNERS[b]).sum() >= 2
    ]
    # Neighbouring cells share the diagonals of the face between them.
    low = np.concatenate([cells + number[a] for a, _ in pairs]) if pairs else cells
    high = np.concatenate([cells + number[b] for _, b in pairs]) if pairs else cells
    low, high = np.minimum(low, high), np.maximum(low, high)
    key = np.unique(low * resolution**3 + high)
    return np.stack([key // resolution**3, key % resolution**3], axis=1)


def _contains(values: NDArray[np.int64], wanted: NDArray[np.int64]) -> NDArray[np.bool_]:
    place = np.minimum(np.searchsorted(values, wanted), len(values) - 1)
    return values[place] == wanted if len(values) else np.zeros(len(wanted), bool)
