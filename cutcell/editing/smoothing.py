"""Smooth weights over the surface, as artists do with a brush."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..geometry.edges import find_edges
from ..geometry.weld import WELD_TOLERANCE, weld
from ..rig.checks import check_integer
from ..rig.rig import TriangleMesh

MAX_PASSES = 1000
STEP = 0.5
"""How far a pass moves a vertex towards its neighbours: half way, so that nothing oscillates."""


def smooth_weights(
    mesh: TriangleMesh, weights: NDArray[np.float64], passes: int
) -> NDArray[np.float64]:
    """Average weights with those of the neighbours along mesh edges, again and again.

    Vertices are welded first, so seams stay closed. Nothing flows between components that
    no edge joins, however close they are.

    Shapes: weights (n, j); returns (n, j).
    """
    passes = check_integer("smoothing", passes, 0, MAX_PASSES)
    if passes == 0:
        return weights
    side = np.ptp(mesh.bounds, axis=0).max()
    welded = weld(mesh.vertices, WELD_TOLERANCE * side)[1]
    step = _step(welded[mesh.faces], int(welded.max()) + 1)
    smoothed = csr_array(_gather(welded)) @ weights
    for _ in range(passes):
        smoothed = step @ smoothed
    return smoothed[welded]


def _gather(welded: NDArray[np.int32]) -> csr_array:
    """Average the vertices that are welded to one."""
    count = np.bincount(welded)
    entries = (1 / count[welded], (welded, np.arange(len(welded))))
    return csr_array(entries, shape=(len(count), len(welded)))


def _step(faces: NDArray[np.int32], vertices: int) -> csr_array:
    """Return one pass as a matrix: half the vertex, half the mean of its neighbours."""
    low, high = find_edges(faces).edges.T
    start, end = np.concatenate([low, high]), np.concatenate([high, low])
    degree = np.bincount(start, minlength=vertices)
    stay = np.where(degree > 0, 1 - STEP, 1.0)
    rows = np.concatenate([start, np.arange(vertices)])
    columns = np.concatenate([end, np.arange(vertices)])
    values = np.concatenate([STEP / degree[start], stay])
    return csr_array((values, (rows, columns)), shape=(vertices, vertices))
