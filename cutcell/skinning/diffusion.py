"""Weights spread over the skin, as far as the skin is away from its bone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags_array
from scipy.sparse.linalg import splu

from .laplacian import cotangent_laplacian, vertex_areas

SHARPNESS = 3.0
"""c: weights spread over about 1 / sqrt(c) of the distance from skin to bone."""
LEAST_CELLS = 0.25
"""Lattice cells; skin on a bone itself would not let go of its weights at all."""


def diffuse(
    points: NDArray[np.float64],
    faces: NDArray[np.int32],
    weights: NDArray[np.float64],
    depth: NDArray[np.float64],
    resolution: int,
) -> NDArray[np.float64]:
    """Find the equilibrium of weights that the skin conducts and its bones hold on to.

        (L + M H) w = M H p,    H = c / depth²

    Without the right side's p being spread already, this is bone heat. Each joint of the
    skeleton bends the skin over a stretch about as long as the limb is thick there.

    Parameters
    ----------
    points : array, shape (k, 3)
        In the unit cube.
    faces : array, shape (m, 3)
    weights : array, shape (k, j)
        p; rows sum to one.
    depth : array, shape (k,)
        Distance to the nearest bone through the body.
    resolution : int
        R, of the lattice that distances were measured on.

    Returns
    -------
    array, shape (k, j)
        Rows sum to one.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4.
    """
    depth = np.maximum(depth, LEAST_CELLS / resolution)
    # A place without area conducts nothing; any positive number lets it keep its own weights.
    hold = np.maximum(vertex_areas(points, faces), 1e-12) * SHARPNESS / depth**2
    system = (cotangent_laplacian(points, faces) + diags_array(hold)).tocsc()
    used = np.flatnonzero(weights.any(axis=0))
    spread = np.zeros_like(weights)
    factors = splu(system, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    spread[:, used] = np.maximum(factors.solve(hold[:, None] * weights[:, used]), 0)
    return spread / spread.sum(axis=1, keepdims=True)
