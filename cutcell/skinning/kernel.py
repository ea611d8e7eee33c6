"""From distances to weights (paper section 3.2, equation 1; Dionne & de Lasa 2013)."""

from __future__ import annotations

import numpy as np
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
    reached = np.isfinite(distance.T)
    x = np.where(reached, distance.T / diagonal, 0)
    steepness = np.where(reached, (1 - alpha) * x + alpha * x * x, np.inf)
    # Relative to the nearest joint nothing overflows, however small the distances.
    least = steepness.min(axis=1, keepdims=True)
    ratio = np.divide(least, steepness, out=np.ones_like(steepness), where=steepness > 0)
    weights = ratio * ratio
    weights /= weights.sum(axis=1, keepdims=True)
    return weights
