"""Seams between vertex buffers that were rounded to different grids (KHR_mesh_quantization)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ....geometry.triangles import face_edges
from ....geometry.weld import weld
from .accessors import Accessor

MAX_ROUNDING = 1e-3
"""Of the longest side; coarser grids are drawn on purpose."""
MAX_GAP = 2**16


def closed_seams(
    vertices: NDArray, faces: NDArray, grids: Sequence[tuple[Accessor, NDArray]]
) -> NDArray:
    """Return vertices (n, 3) with borders in one place that run along each other within a step.

    Grids are positions as they are stored, and their matrices (4, 4) to the vertices.
    """
    integers = [(stored, to) for stored, to in grids if stored.base.dtype.kind != "f"]
    if len({to.tobytes() for _, to in grids}) < 2 or not integers:
        return vertices
    # Exporters round to fewer bits than they store: all meshes of a file to as many.
    gaps = [np.diff(np.unique(stored.stored()).astype(int)) for stored, _ in integers]
    gap = min(one.min(initial=MAX_GAP) for one in gaps)
    tolerance = gap * max(np.linalg.norm(to[:3, :3]) / stored.one for stored, to in integers)
    if tolerance > MAX_ROUNDING * np.ptp(vertices, axis=0).max():
        return vertices
    points, index = weld(vertices, 0.0)
    edges, count = np.unique(face_edges(index[faces]), axis=0, return_counts=True)
    rim, ends = np.unique(edges[count == 1], return_inverse=True)
    places, group = weld(points[rim], tolerance)
    sides, count = np.unique(np.sort(group[ends].reshape(-1, 2)), axis=0, return_counts=True)
    is_shut = np.isin(group, sides[(count > 1) & (sides[:, 0] != sides[:, 1])])
    points[rim[is_shut]] = places[group[is_shut]]
    return points[index]
