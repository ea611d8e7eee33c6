"""Seams between vertex buffers that were rounded to grids of their own: quantised, or by Draco."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ....geometry.edges import find_edges
from ....geometry.weld import weld

MAX_STEP = 1e-3
"""Of the longest side; coarser grids are drawn on purpose."""


def closed_seams(
    vertices: NDArray, faces: NDArray, grids: Mapping[tuple[int, bytes], list[NDArray]]
) -> NDArray:
    """Return vertices (n, 3) with borders in one place that run along each other within a step.

    Grids hold positions as they are stored, in units of the vertices; none of what is exact.
    """
    values = [np.sort(np.concatenate(stored), axis=0) for stored in grids.values() if stored]
    if len(grids) < 2 or not values:
        return vertices
    # Exporters round all meshes of a file to as many bits, fewer than they store.
    sizes = [max(float((one[-1] - one[0]).max()), 1e-300) for one in values]
    gaps = [np.diff(one, axis=0) for one in values]
    parts = [g.min(initial=np.inf, where=g > 0) / s for g, s in zip(gaps, sizes, strict=True)]
    tolerance = min(parts) * max(sizes)
    if tolerance > MAX_STEP * np.ptp(vertices, axis=0).max():
        return vertices
    points, index = weld(vertices, 0.0)
    edges = find_edges(index[faces])
    rim, ends = np.unique(edges.edges[edges.uses == 1], return_inverse=True)
    places, group = weld(points[rim], tolerance)
    sides, count = np.unique(np.sort(group[ends].reshape(-1, 2)), axis=0, return_counts=True)
    is_shut = np.isin(group, sides[(count > 1) & (sides[:, 0] != sides[:, 1])])
    points[rim[is_shut]] = places[group[is_shut]]
    return points[index]
