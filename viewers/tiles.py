"""How views that stand side by side share a picture."""

from __future__ import annotations

from math import ceil

Tile = tuple[int, int, int, int]
"""Left, top, width and height of a view, in pixels."""


def tiles(count: int, size: tuple[int, int], shape: float = 0.75) -> list[Tile]:
    """Divide a picture among views, so that what stands in each is seen as large as can be.

    Parameters
    ----------
    count : int
    size : (int, int)
        Width and height of the picture.
    shape : float
        Width over height of what is shown.

    Returns
    -------
    list of (left, top, width, height)
        Row by row from the upper left. The page's view divides its canvas in the same way.
    """
    width, height = size

    def seen(columns: int) -> float:
        return min(width / columns / shape, height / ceil(count / columns))

    columns = max(range(1, max(count, 1) + 1), key=seen)
    rows = ceil(count / columns)
    places = []
    for k in range(count):
        row, column = divmod(k, columns)
        along = min(columns, count - row * columns)  # the last row shares what it has
        left, right = (round(width * c / along) for c in (column, column + 1))
        top, bottom = (round(height * r / rows) for r in (row, row + 1))
        places.append((left, top, right - left, bottom - top))
    return places
