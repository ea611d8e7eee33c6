"""Orders of items by group, and of points by the cell of a grid that they are in."""

import numpy as np
from numpy.typing import NDArray

GRID_CELLS = 64
"""Along each side of the grid that points are sorted into."""


def spatial_order(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """Order points, shape (n, 3), in the unit cube by the cells of a grid that they are in.

    Near points are then near in memory, so that large meshes make better use of the cache.
    """
    x, y, z = (points * GRID_CELLS).astype(np.int64).T
    return np.argsort((x * GRID_CELLS + y) * GRID_CELLS + z, kind="stable")


def sort_by_group(
    group: NDArray[np.integer], count: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Sort items by group, the items of each in order; those of negative groups are left out.

    Shapes: group (n,); returns start (count + 1,), order (start[-1],).
    """
    order = np.argsort(group, kind="stable")
    start = np.searchsorted(group[order], np.arange(count + 1))
    return start - start[0], order[start[0] :]
