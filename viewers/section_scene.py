"""The inside of a cut body, coloured by a field of the graph's nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from cutcell.graph import CutCellGraph, RaySlice, slice_rays
from cutcell.rig import Rig

from .character import to_scene
from .description import Actor

FINEST, COARSEST = 192, 96
"""Rows of the section along the longest side; twice the lattice's in between."""
NEAREST = 4
"""How many nodes each value is mixed of."""


def section_resolution(graph: CutCellGraph) -> int:
    """Return how many rows a section of this graph has."""
    return int(np.clip(2 * graph.lattice.resolution, COARSEST, FINEST))


def section_rays(
    rig: Rig,
    graph: CutCellGraph,
    normal: int,
    index: int,
    winding_threshold: float,
    orient: bool = True,
) -> RaySlice:
    """Return the rays that a section is made of, finer than the lattice."""
    return slice_rays(
        rig.mesh,
        section_resolution(graph),
        axis=(normal + 1) % 3,
        normal=normal,
        index=index,
        winding_threshold=winding_threshold,
        orient=orient,
    )


def section(rig: Rig, graph: CutCellGraph, found: RaySlice, normal: int, field: ArrayLike) -> Actor:
    """Return the inside of a cut as an actor with the field's values.

    Parameters
    ----------
    rig : Rig
    graph : CutCellGraph
    found : RaySlice
        From `section_rays`.
    normal : int
        The axis of the rig's space that the cut is perpendicular to.
    field : array_like, shape (N,)
        A value at each node; infinite where none is known.
    """
    axis = (normal + 1) % 3
    low, high = found.low[found.kept], found.high[found.kept]
    aside = np.zeros(3)
    aside[3 - axis - normal] = 0.5 / found.lattice.resolution
    corners = np.stack([low - aside, high - aside, high + aside, low + aside], axis=1)
    # Rows share the values of their common edge, so that colours run on without a step.
    scalars = values_at(graph, corners.reshape(-1, 3), field)
    faces = 4 * np.arange(len(low))[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])
    points = to_scene(rig, found.lattice.to_file(corners.reshape(-1, 3)))
    return Actor(
        "surface",
        points.astype(np.float32),
        faces.reshape(-1, 3).astype(np.int32),
        scalars=scalars.astype(np.float32),
        clipped=False,
    )


def values_at(
    graph: CutCellGraph, points: NDArray[np.float64], field: ArrayLike
) -> NDArray[np.float64]:
    """Mix a field's values at the nodes nearest to points (p, 3) of the unit cube."""
    field = np.asarray(field, float)
    known = np.flatnonzero(np.isfinite(field) & graph.connected)
    if not len(known):
        return np.full(len(points), np.inf)
    count = min(NEAREST, len(known))
    distance, nearest = cKDTree(graph.nodes[known]).query(points, k=list(range(1, count + 1)))
    share = 1 / np.maximum(distance, 1e-9) ** 2
    return (share * field[known][nearest]).sum(axis=1) / share.sum(axis=1)
