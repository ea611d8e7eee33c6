"""What all formats do with the weights they read."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def normalised(weights: NDArray) -> NDArray[np.float64]:
    """Scale each row to sum to one; rows of zero stay zero."""
    sums = weights.sum(axis=1, keepdims=True)
    return np.divide(weights, sums, out=np.zeros(weights.shape), where=sums > 0)


def carrying(weights: NDArray | None) -> NDArray[np.bool_] | None:
    """Return which joints carry weight, shape (j,), or None (all may) when none does."""
    if weights is None or not weights.any():
        return None
    return np.asarray((weights > 0).any(axis=0))
