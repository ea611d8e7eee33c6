"""In-painting: weights of the other vertices of a mesh, as smooth as those of some allow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from ...geometry.welded import WeldedMesh

MIN_AREA = 1e-9
"""Least area of a vertex, as part of the mean: the energy divides by it."""


def inpaint(
    mesh: WeldedMesh, fixed: NDArray[np.bool_], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return weights (k, j) that minimise the bi-Laplacian energy with the fixed rows as they are.

    A component without fixed rows keeps its rows. Rows are not negative and sum to one.

    References
    ----------
    Abdrashitov et al. 2023, "Robust skin weights transfer via weight inpainting".
    """
    has_fixed = np.bincount(mesh.component, fixed, mesh.component.max() + 1) > 0
    unknown = np.flatnonzero(~fixed & has_fixed[mesh.component])
    if not len(unknown):
        return weights
    start, column, value = mesh.stiffness
    stiffness = csr_array((value, column, start), (len(fixed), len(fixed)))
    areas = np.maximum(mesh.areas, MIN_AREA * mesh.areas.mean())
    rows = stiffness[unknown]
    energy = rows @ diags_array(1 / areas) @ stiffness
    joints = np.flatnonzero(weights[fixed].any(axis=0))
    fixed_rows = np.flatnonzero(fixed)
    right = -(energy[:, fixed_rows] @ weights[np.ix_(fixed_rows, joints)])
    solved = splu(csc_array(energy[:, unknown])).solve(right)
    result = weights.copy()
    result[unknown] = 0.0
    result[np.ix_(unknown, joints)] = np.maximum(solved, 0.0)
    total = result.sum(axis=1, keepdims=True)
    return np.divide(result, total, out=result, where=total > 0)
