"""Transforms of joints: relative to their parents, and put together again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def relative(transforms: NDArray, parents: NDArray) -> NDArray[np.float64]:
    """Return transforms (..., j, 4, 4) relative to those of the parents (j,); roots' stay."""
    local, lower = transforms.astype(np.float64), np.flatnonzero(parents >= 0)
    back = inverses(transforms[..., parents[lower], :, :])
    local[..., lower, :, :] = back @ local[..., lower, :, :]
    return local


def composed(local: NDArray, parents: NDArray) -> NDArray[np.float64]:
    """Put every ancestor's transform in front of each joint's own (..., j, 4, 4), by doubling.

    After step k each joint holds the product over its nearest 2^k ancestors, in any order.
    """
    transforms, above = local.astype(np.float64), parents.copy()
    while (descendants := np.flatnonzero(above >= 0)).size:
        before = transforms[..., above[descendants], :, :]
        transforms[..., descendants, :, :] = before @ transforms[..., descendants, :, :]
        above[descendants] = above[above[descendants]]
    return transforms


def inverses(matrices: NDArray) -> NDArray[np.float64]:
    """Invert matrices (..., 4, 4); of a joint that is scaled to nothing, as far as can be."""
    try:
        return np.linalg.inv(matrices).astype(np.float64)
    except np.linalg.LinAlgError:
        return np.linalg.pinv(matrices).astype(np.float64)


def moved(points: NDArray, matrix: NDArray) -> NDArray[np.float64]:
    """Return points (n, 3) moved by a matrix (4, 4), the same if it is the identity."""
    if np.array_equal(matrix, np.eye(4)):
        return points
    return points @ matrix[:3, :3].T + matrix[:3, 3]
