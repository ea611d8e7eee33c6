"""Weights spread over the skin, as far as the skin is away from its bone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from ..threads import in_threads
from .laplacian import cotangent_laplacian, vertex_areas

SHARPNESS = 3.0
"""c: weights spread over about 1 / sqrt(c) of the distance from skin to bone."""
LANES = 16
"""Joints that are solved for side by side."""
LEAST_CELLS = 0.25
"""Lattice cells; skin on a bone itself would not let go of its weights at all."""


@dataclass(frozen=True, eq=False)
class Diffusion:
    """The equilibrium of weights that the skin conducts and its bones hold on to.

        (L + M H) w = M H p,    H = c / depth²

    Without the right side's p being spread already, this is bone heat. Each joint of the
    skeleton bends the skin over a stretch about as long as the limb is thick there.

    Parameters
    ----------
    hold : array, shape (k,)
        The diagonal of M H.
    triangle : tuple of arrays
        L and D of L D Lᵀ, the factors of the matrix: column starts, rows, values, diagonal.
    order : array, shape (k,), int32
        Where each place stands in them.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4.
    """

    hold: NDArray[np.float64]
    triangle: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]
    order: NDArray[np.int32]

    @classmethod
    def over(
        cls,
        points: NDArray[np.float64],
        faces: NDArray[np.int32],
        depth: NDArray[np.float64],
        resolution: int,
    ) -> Diffusion:
        """Prepare the equation of a mesh; most of the time goes here.

        Parameters
        ----------
        points : array, shape (k, 3)
            In the unit cube.
        faces : array, shape (m, 3)
        depth : array, shape (k,)
            Distance to the nearest bone through the body.
        resolution : int
            R, of the lattice that distances were measured on.
        """
        depth = np.maximum(depth, LEAST_CELLS / resolution)
        # A place without area conducts nothing; any positive number lets it keep its own weights.
        hold = np.maximum(vertex_areas(points, faces), 1e-12) * SHARPNESS / depth**2
        system = cotangent_laplacian(points, faces, hold).T  # itself, column by column
        factors = splu(
            system,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            panel_size=2,
            options={"SymmetricMode": True},
        )
        lower = factors.L
        triangle = lower.indptr, lower.indices, lower.data, factors.U.diagonal()
        return cls(hold, triangle, factors.perm_c)

    def spread(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the equilibrium of weights p, shape (k, j); rows sum to one before and after."""
        used = np.flatnonzero(weights.any(axis=0))
        spread = np.zeros_like(weights)
        known = self.order, self.hold, weights
        in_threads(
            lambda joints: _solve(*self.triangle, *known, joints, spread),
            [used[first : first + LANES] for first in range(0, len(used), LANES)],
        )
        spread /= spread.sum(axis=1, keepdims=True)
        return spread


@njit(cache=True, nogil=True)
def _solve(indptr, indices, values, diagonal, order, hold, weights, joints, spread):
    """Put the equilibrium of some joints' weights into `spread`."""
    rows = np.empty((len(order), len(joints)))
    for k in range(len(order)):
        for lane in range(len(joints)):
            rows[order[k], lane] = hold[k] * weights[k, joints[lane]]
    _substitute(indptr, indices, values, diagonal, rows)
    for k in range(len(order)):
        for lane in range(len(joints)):
            spread[k, joints[lane]] = max(rows[order[k], lane], 0.0)


@njit(cache=True, nogil=True)
def _substitute(indptr, indices, values, diagonal, rows):
    """Solve L D Lᵀ x = b for many b side by side, in place; L has ones on its diagonal."""
    count, lanes = rows.shape
    for c in range(count):
        if not rows[c].any():
            continue
        for p in range(indptr[c], indptr[c + 1]):
            r = indices[p]
            if r > c:
                for lane in range(lanes):
                    rows[r, lane] -= values[p] * rows[c, lane]
    for c in range(count - 1, -1, -1):
        for lane in range(lanes):
            rows[c, lane] /= diagonal[c]
        for p in range(indptr[c], indptr[c + 1]):
            r = indices[p]
            if r > c:
                for lane in range(lanes):
                    rows[c, lane] -= values[p] * rows[r, lane]
