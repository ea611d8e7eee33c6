"""From distances to weights (paper section 3.2, equation 1; Dionne & de Lasa 2013)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


def paper_kernel(
    distance: NDArray[np.float64], diagonal: float, alpha: float
) -> NDArray[np.float64]:
    """Apply the paper's falloff and normalise over the joints.

        w = (1 / ((1 - alpha) d/D + alpha (d/D)^2))^2

    Parameters
    ----------
    distance : array, shape (j, n)
        d; infinite for joints without influence.
    diagonal : float
        D, in the unit of the distances.
    alpha : float
        Smoothness: 0 falls off like d^-2, 1 like d^-4.

    Returns
    -------
    array, shape (n, j)
        Rows sum to one. A vertex that touches bones (d = 0) follows these alone: the limit
        of the formula.
    """
    weights = np.empty(distance.shape[::-1])
    _paper_kernel(distance, diagonal, alpha, weights)
    return weights


@njit(cache=True)
def _paper_kernel(distance, diagonal, alpha, weights):
    for v in range(len(weights)):
        least = np.inf
        for j in range(len(distance)):
            x = distance[j, v] / diagonal
            steepness = (1 - alpha) * x + alpha * x * x if x < np.inf else np.inf
            weights[v, j] = steepness
            least = min(least, steepness)
        # Relative to the nearest joint nothing overflows, however small the distances.
        total = 0.0
        for j in range(len(distance)):
            steepness = weights[v, j]
            ratio = least / steepness if steepness > 0 else 1.0
            weights[v, j] = ratio * ratio
            total += ratio * ratio
        weights[v] /= total
