"""Few influences a vertex, as files and graphics cards want them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def prune(
    weights: NDArray[np.float64],
    max_influences: int | None,
    threshold: float,
    priority: NDArray[np.intp],
) -> NDArray[np.float64]:
    """Keep the largest weights of each vertex and make them sum to one again.

    Parameters
    ----------
    weights : array, shape (n, j)
        Rows sum to one.
    max_influences : int or None
        Weights kept a vertex, at most; None keeps all.
    threshold : float
        Weights below it are dropped; a vertex always keeps its largest.
    priority : array, shape (j,)
        The joints in the order in which they are kept among equal weights.

    Returns
    -------
    array, shape (n, j)
    """
    largest = weights.max(axis=1, keepdims=True)
    kept = np.where((weights >= threshold) | (weights == largest), weights, 0.0)
    if max_influences is not None and max_influences < weights.shape[1]:
        order = np.argsort(-kept[:, priority], axis=1, kind="stable")
        np.put_along_axis(kept, priority[order[:, max_influences:]], 0.0, axis=1)
    return kept / kept.sum(axis=1, keepdims=True)
