"""Interpolation of fields between the nodes of a graph."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from cutcell.graph import CutCellGraph

NEAREST = 16
"""Nodes that each value is fitted to."""
RADIUS = 1.3
"""Radius within which nodes count, in cells of the lattice."""
STEEPEST = 1.8
"""Nodes whose values differ by more than this, times their distance, lie on another limb: paths
of six directions are up to the square root of 3 longer than straight lines."""


def interpolate(
    graph: CutCellGraph, points: NDArray[np.float64], field: ArrayLike
) -> NDArray[np.float64]:
    """Return a field's values at points (p, 3) of the unit cube, shape (p,).

    Each is that of the linear function that fits the values at near nodes best, the nearer ones
    more (moving least squares), without nodes that are near through the air alone.

    Parameters
    ----------
    graph : CutCellGraph
    points : array, shape (p, 3)
    field : array_like, shape (N,)
        A distance at each node; infinite where none is known.
    """
    field = np.asarray(field, float)
    nodes = np.flatnonzero(graph.connected)
    if not len(nodes) or not len(points):
        return np.full(len(points), np.inf)
    count = min(NEAREST, len(nodes))
    distance, near = cKDTree(graph.nodes[nodes]).query(points, k=list(range(1, count + 1)))
    near = nodes[near]
    value, place = field[near], graph.nodes[near]
    first = np.where(np.isfinite(value[:, :1]), value[:, :1], 0.0)
    steep = STEEPEST * np.linalg.norm(place - place[:, :1], axis=2) + 1e-9
    radius = np.maximum(RADIUS / graph.lattice.resolution, distance[:, :1])
    with np.errstate(invalid="ignore"):
        counts = np.isfinite(value) & (np.abs(value - first) <= steep)
    share = np.exp(-((distance / radius) ** 2)) * counts
    above_first = np.where(counts, value - first, 0.0)
    displacement = (place - points[:, None]) / radius[..., None]
    basis = np.concatenate([np.ones((*distance.shape, 1)), displacement], axis=2)
    moments = np.einsum("pk,pki,pkj->pij", share, basis, basis)
    moments += np.diag([1e-12, 1e-5, 1e-5, 1e-5]) * (share.sum(axis=1) + 1e-12)[:, None, None]
    fitted = np.linalg.solve(
        moments, np.einsum("pk,pk,pki->pi", share, above_first, basis)[..., None]
    )
    low = np.where(counts, above_first, np.inf).min(axis=1)
    high = np.where(counts, above_first, -np.inf).max(axis=1)
    spread = 0.5 / graph.lattice.resolution
    values = first[:, 0] + np.clip(fitted[:, 0, 0], low - spread, high + spread)
    return np.where(np.isfinite(value[:, 0]), np.maximum(values, 0.0), np.inf)
