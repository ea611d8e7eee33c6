"""Closest points on segments; `vectors.segment_fraction` is the form for kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def closest_on_segment(
    points: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the closest points on segments, (..., 3), and where these lie, 0 to 1, (...)."""
    along = end - start
    fraction = _fraction(points - start, along)
    return start + fraction[..., None] * along, fraction


def distance_to_segment(points: ArrayLike, start: ArrayLike, end: ArrayLike) -> NDArray:
    """Compute the distance from points (..., 3) to segments (..., 3), broadcast."""
    points, start, end = (np.asarray(x, np.float64) for x in (points, start, end))
    along, away = end - start, points - start
    # Rounded less than the distance to `closest_on_segment`.
    nearest = away - _fraction(away, along)[..., None] * along
    return np.sqrt(_dot(nearest, nearest))


def _fraction(away: NDArray[np.float64], along: NDArray[np.float64]) -> NDArray[np.float64]:
    squared = _dot(along, along)
    return np.clip(_dot(away, along) / np.where(squared > 0, squared, 1), 0, 1)


def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("...i,...i->...", a, b)  # faster than a sum over the last axis
