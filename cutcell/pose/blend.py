"""Linear blend skinning."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ParameterError


def linear_blend_skinning(
    vertices: ArrayLike, weights: ArrayLike, transforms: ArrayLike
) -> NDArray[np.float64]:
    """Move each vertex by the weighted mean of the transforms of its joints.

    Parameters
    ----------
    vertices : array_like, shape (n, 3), float64
        Rest positions.
    weights : array_like, shape (n, j), float64
        Rows sum to one; where a row is all zero the vertex stays where it is.
    transforms : array_like, shape (j, 4, 4), float64
        Skinning matrices, as `forward_kinematics` returns.

    Returns
    -------
    array, shape (n, 3), float64

    Raises
    ------
    ParameterError
        Shapes that do not fit each other.
    """
    points = np.asarray(vertices, np.float64)
    shares = np.asarray(weights, np.float64)
    matrices = np.asarray(transforms, np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ParameterError(f"vertices have the shape {points.shape}, expected (n, 3)")
    if shares.ndim != 2 or matrices.shape != (shares.shape[1], 4, 4):
        raise ParameterError(
            f"transforms have the shape {matrices.shape}, but the weights, {shares.shape}, "
            "need (j, 4, 4) for (n, j)"
        )
    if len(shares) != len(points):
        raise ParameterError(f"{len(points)} vertices but {len(shares)} rows of weights")
    blended = (shares @ matrices[:, :3].reshape(-1, 12)).reshape(-1, 3, 4)
    posed = np.einsum("nab,nb->na", blended[:, :, :3], points) + blended[:, :, 3]
    is_weighted = np.abs(shares).sum(axis=1, keepdims=True) > 0
    return np.where(is_weighted, posed, points)
