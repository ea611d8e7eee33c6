"""The kernel of the paper (section 3.2, equation 1; Dionne & de Lasa 2013)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled
from ..runtime.threads import in_threads, parts


def paper_kernel(
    distance: NDArray[np.float64], diagonal: float, alpha: float
) -> NDArray[np.float64]:
    """Apply the paper's falloff and normalise over the joints.

        w = (1 / ((1 - alpha) d/D + alpha (d/D)^2))^2

    Shapes: distance (j, n); returns (n, j).
    """
    weights = np.empty(distance.shape[::-1])
    in_threads(
        lambda part: _paper_kernel(distance, diagonal, alpha, weights, part.start, part.stop),
        parts(len(weights)),
    )
    return weights


BLOCK_ROWS = 64
"""Vertices at a time: distances are stored by joint, and a block of rows fits into the cache."""


@compiled
def _paper_kernel(distance, diagonal, alpha, weights, begin, stop):
    for first in range(begin, stop, BLOCK_ROWS):
        _kernel_rows(
            distance, diagonal, alpha, first, weights[first : min(first + BLOCK_ROWS, stop)]
        )


@compiled
def _kernel_rows(distance, diagonal, alpha, first, rows):
    for j in range(len(distance)):
        for v in range(len(rows)):
            x = distance[j, first + v] / diagonal
            rows[v, j] = (1 - alpha) * x + alpha * x * x if x < np.inf else np.inf
    for v in range(len(rows)):
        _normalise(rows[v])


@compiled
def _normalise(row):
    least = np.inf
    for steepness in row:
        least = min(least, steepness)
    # Relative to the nearest joint nothing overflows, however small the distances are.
    total = 0.0
    for j, steepness in enumerate(row):
        if steepness == np.inf:
            row[j] = 0.0
            continue
        ratio = least / steepness if steepness > 0 else 1.0
        row[j] = ratio * ratio
        total += ratio * ratio
    row /= total
