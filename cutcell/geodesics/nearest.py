"""Nearest nodes of points, by a grid over the unit cube.

There are a few hundred points and many nodes: sorting the nodes into a coarse grid, in one pass, is
far faster than building a tree over them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.counting_sort import counting_sort
from ..runtime.compiled import compiled

IN_A_CELL = 4
"""Lattice cells along each side of a cell of the grid."""
MAX_CELLS = 64
"""Along each side of the grid: limits its memory to that of the nodes."""


class NodeGrid:
    """Nodes sorted into a grid.

    Parameters
    ----------
    nodes : array, shape (N, 3)
        In the unit cube.
    chosen : array, shape (N,), bool
        Which of them may be found.
    resolution : int
        R, of the lattice that the nodes are of.
    """

    def __init__(
        self, nodes: NDArray[np.float64], chosen: NDArray[np.bool_], resolution: int
    ) -> None:
        self._nodes, self._resolution = nodes, resolution
        self._side = max(1, min(resolution // IN_A_CELL, MAX_CELLS))
        self._start, self._order = _sort_into_cells(nodes, chosen, self._side)

    def nearest(
        self, points: NDArray[np.float64], tie: float
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Find the nearest nodes of each point: all that are equally near up to rounding.

        Shapes: points (p, 3); returns point, node (f,).
        """
        capacity = 8 * len(points)  # the middle of a lattice cell is equally near to all corners
        while True:
            pairs = np.empty((2, capacity), np.int64)
            grid = self._nodes, self._start, self._order, self._side
            count = _find_nearest(grid, points, 1 + tie, pairs)
            if count <= capacity:
                return pairs[0, :count], pairs[1, :count]
            capacity = count

    def near(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return for each point (p, 3) whether a node is in its lattice cell or next to it."""
        # Points far outside are moved to where they still have no neighbour in the cube.
        grid = self._nodes, self._start, self._order, self._side
        return _is_near(grid, self._resolution, np.clip(points, -1, 2))


@compiled(inline="always")
def _cell(x, side):
    return min(max(int(np.floor(x * side)), 0), side - 1)


@compiled
def _sort_into_cells(nodes, chosen, side):
    """Sort the chosen nodes by cell; return where each cell begins, and their order."""
    count = len(nodes)
    cell = np.full(count, -1, np.int32)
    for n in range(count):
        if chosen[n]:
            x, y, z = _cell(nodes[n, 0], side), _cell(nodes[n, 1], side), _cell(nodes[n, 2], side)
            cell[n] = (x * side + y) * side + z
    return counting_sort(cell, side * side * side)


@compiled
def _find_nearest(grid, points, slack, pairs):
    """List nodes for each point; return their number, even if it exceeds the capacity."""
    nodes, start, order, side = grid
    count = 0
    for p in range(len(points)):
        x, y, z = points[p]
        least = _near_enough(grid, x, y, z)
        for listing in range(2):
            limit = least * slack * slack
            around = np.sqrt(limit)
            low, high = _cell(z - around, side), _cell(z + around, side)
            for i in range(_cell(x - around, side), _cell(x + around, side) + 1):
                for j in range(_cell(y - around, side), _cell(y + around, side) + 1):
                    row = (i * side + j) * side
                    for o in range(start[row + low], start[row + high + 1]):
                        squared = _squared(nodes, order[o], x, y, z)
                        least = min(least, squared)
                        if listing and squared <= limit:
                            if count < pairs.shape[1]:
                                pairs[0, count], pairs[1, count] = p, order[o]
                            count += 1
    return count


@compiled
def _near_enough(grid, x, y, z):
    """Return the squared distance to the nearest node in the innermost shell of cells with any."""
    nodes, start, order, side = grid
    cx, cy, cz = _cell(x, side), _cell(y, side), _cell(z, side)
    least, reach = np.inf, 0
    while least == np.inf and reach <= side:
        for i in range(max(cx - reach, 0), min(cx + reach + 1, side)):
            for j in range(max(cy - reach, 0), min(cy + reach + 1, side)):
                # Only the shell is new: of an inner row of cells, both ends.
                inner = abs(i - cx) < reach and abs(j - cy) < reach
                for k in range(cz - reach, cz + reach + 1, 2 * reach if inner else 1):
                    if 0 <= k < side:
                        c = (i * side + j) * side + k
                        for o in range(start[c], start[c + 1]):
                            least = min(least, _squared(nodes, order[o], x, y, z))
        reach += 1
    return least


@compiled
def _is_near(grid, resolution, points):
    nodes, start, order, side = grid
    is_near = np.zeros(len(points), np.bool_)
    for p in range(len(points)):
        x, y, z = points[p, 0] * resolution, points[p, 1] * resolution, points[p, 2] * resolution
        x, y, z = np.floor(x), np.floor(y), np.floor(z)
        x0, x1 = _cell((x - 1) / resolution, side), _cell((x + 2) / resolution, side)
        y0, y1 = _cell((y - 1) / resolution, side), _cell((y + 2) / resolution, side)
        z0, z1 = _cell((z - 1) / resolution, side), _cell((z + 2) / resolution, side)
        for i in range(x0, x1 + 1):
            for j in range(y0, y1 + 1):
                row = (i * side + j) * side
                for o in range(start[row + z0], start[row + z1 + 1]):
                    n = order[o]
                    is_near[p] |= (
                        abs(np.floor(nodes[n, 0] * resolution) - x) <= 1
                        and abs(np.floor(nodes[n, 1] * resolution) - y) <= 1
                        and abs(np.floor(nodes[n, 2] * resolution) - z) <= 1
                    )
                    if is_near[p]:
                        break
                if is_near[p]:
                    break
            if is_near[p]:
                break
    return is_near


@compiled(inline="always")
def _squared(nodes, n, x, y, z):
    x, y, z = nodes[n, 0] - x, nodes[n, 1] - y, nodes[n, 2] - z
    return x * x + y * y + z * z
