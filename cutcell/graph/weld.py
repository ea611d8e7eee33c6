"""Merge the vertices that exporters split at texture and normal seams."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

WELD_TOLERANCE = 1e-6
"""Of the bounding box's longest side: far above float32 rounding, far below any detail."""


def weld(
    points: NDArray[np.float64], tolerance: float = WELD_TOLERANCE
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Merge points that lie within `tolerance` of each other, also in chains.

    The result is sorted by coordinates, so it does not depend on the order of the input.

    Parameters
    ----------
    points : array, shape (n, 3)
    tolerance : float
        In the units of the points.

    Returns
    -------
    welded : array, shape (k, 3)
        One of the given points for each group: the first by coordinates.
    index : array, shape (n,), int32
        The group of each point.
    """
    order = np.lexsort(points.T[::-1])
    ordered = points[order]
    first = np.ones(len(points), bool)
    first[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    distinct = ordered[first]
    index = np.empty(len(points), np.int32)
    index[order] = np.cumsum(first) - 1

    pairs = cKDTree(distinct).query_pairs(tolerance, output_type="ndarray")
    if len(pairs) == 0:
        return distinct, index
    shape = (len(distinct), len(distinct))
    links = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=shape)
    # Labels count up in the order of each group's first point, so they stay sorted.
    labels = connected_components(links, directed=False)[1]
    _, lowest = np.unique(labels, return_index=True)
    rank = np.argsort(np.argsort(lowest))
    return distinct[np.sort(lowest)], rank[labels[index]].astype(np.int32)
