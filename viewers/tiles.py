"""Division of a picture among views side by side."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from .camera import FRONT, across

Tile = tuple[int, int, int, int]
"""Left, top, width and height of a view, in pixels."""


def tiles(count: int, size: tuple[int, int], shape: float = 0.75) -> list[Tile]:
    """Divide a picture among views, so that their contents are as large as possible.

    Parameters
    ----------
    count : int
    size : (int, int)
        Width and height of the picture.
    shape : float
        Width over height of the contents.

    Returns
    -------
    list of (left, top, width, height)
        Row by row from the upper left. The page's view divides its canvas in the same way, but
        leaves room for the captions.
    """
    width, height = size

    def scale_of(columns: int) -> float:
        return min(width / columns / shape, height / ceil(count / columns))

    columns = max(range(1, max(count, 1) + 1), key=scale_of)
    rows = ceil(count / columns)
    places = []
    for k in range(count):
        row, column = divmod(k, columns)
        along = min(columns, count - row * columns)  # the last row shares what it has
        left, right = (round(width * c / along) for c in (column, column + 1))
        top, bottom = (round(height * r / rows) for r in (row, row + 1))
        places.append((left, top, right - left, bottom - top))
    return places


def shape_of(bounds: NDArray[np.float64]) -> float:
    """Return width over height of a box as it is seen at first, from 0.4 to 2.5.

    Parameters
    ----------
    bounds : array, shape (2, 3)
    """
    right, up, _ = across(FRONT)
    size = np.maximum(np.ptp(bounds, axis=0), 1e-9)
    return float(np.clip(np.abs(right) @ size / (np.abs(up) @ size), 0.4, 2.5))
