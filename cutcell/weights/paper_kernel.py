"""The kernel of the paper (section 3.2, equation 1; Dionne & de Lasa 2013)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.vectors import TIE
from ..runtime.threads import in_threads, parts, threads

KERNEL_PART = 100_000
"""Weights of one part of the work: they fit into the cache."""


def paper_kernel(
    distance: NDArray[np.float64], diagonal: float, alpha: float
) -> NDArray[np.float64]:
    """Apply the paper's falloff and normalise over the joints.

        w = (1 / ((1 - alpha) d/D + alpha (d/D)^2))^2

    Shapes: distance (j, n); returns (n, j).
    """
    weights = np.empty(distance.shape[::-1])

    def weigh(part: slice) -> None:
        x = np.maximum(distance[:, part], TIE) / diagonal
        is_far = np.isinf(x)
        x[is_far] = 0.0
        steepness = (1 - alpha) * x + alpha * x * x
        steepness[is_far] = np.inf
        # Relative to the nearest joint nothing overflows, however small the distances are.
        least = np.broadcast_to(steepness.min(axis=0), x.shape)
        weight = np.divide(least, steepness, out=np.ones_like(x), where=steepness > 0) ** 2
        weights[part] = (weight / weight.sum(axis=0)).T

    in_threads(weigh, parts(len(weights), threads() + weights.size // KERNEL_PART))
    return weights
