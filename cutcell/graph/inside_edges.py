"""Edges inside the body: kept segments, and the diagonals of cells that lie entirely inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import no_refcount
from .interior import OUTSIDE, point_number, point_on_ray
from .segments import NONE


@no_refcount
def fill_edges(where, intervals, table, ends, edges, lengths):
    """List the kept segments along one axis as edges.

    `intervals` are the arrays of `InsideIntervals` and the first edge of each; `ends` are position
    and surface node of each hit, shapes (c,).
    """
    resolution, axis, first_point = where
    ray, first, last, low, high, start = intervals
    position, surface_node = ends
    for r in range(len(ray)):
        e = start[r]
        previous, previous_position = NONE, 0.0
        if low[r] != NONE:
            previous, previous_position = surface_node[low[r]], position[low[r]]
        for k in range(first[r], last[r] + 1):
            column, z = point_on_ray(axis, ray[r], k, resolution)
            point = point_number(table[0], table[1], table[2], table[3], column, z)
            if previous != NONE:
                edges[e, 0], edges[e, 1] = previous, first_point + point
                lengths[e] = (k + 0.5) / resolution - previous_position
                e += 1
            previous, previous_position = first_point + point, (k + 0.5) / resolution
        if high[r] != NONE:
            edges[e, 0], edges[e, 1] = previous, surface_node[high[r]]
            lengths[e] = position[high[r]] - previous_position


def lattice_steps(
    nodes: NDArray[np.float64], edges: NDArray[np.int32], first: int, last: int
) -> NDArray[np.int32]:
    """List the neighbours of interior points, +x, +y, +z, -x, -y, -z, shape (last - first, 6)."""
    steps = np.full((last - first, 6), OUTSIDE, np.int32)
    low, high = edges[((edges >= first) & (edges < last)).all(axis=1)].T
    axis = (nodes[low] < nodes[high]).argmax(axis=1)
    steps[low - first, axis] = high - first
    steps[high - first, 3 + axis] = low - first
    return steps


def cells_inside(steps: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Return which interior points are the lowest corner of a cell whose twelve edges lie inside.

    Shapes: steps (p, 6), as of `lattice_steps`; returns (p,).
    """
    # OUTSIDE is also the index of the last row.
    step = np.append(steps, np.full((1, 6), OUTSIDE, np.int32), axis=0)
    x, y, z = steps[:, 0], steps[:, 1], steps[:, 2]
    xy, yz, zx = step[x, 1], step[y, 2], step[z, 0]
    top = step[xy, 2]
    is_inside = (top != OUTSIDE) & (step[yz, 0] == top) & (step[zx, 1] == top)
    return is_inside & (xy == step[y, 0]) & (yz == step[z, 1]) & (zx == step[x, 2])


def diagonal_edges(steps: NDArray[np.int32]) -> NDArray[np.int32]:
    """List the face and body diagonals of the cells that lie inside, (p, 6) to (d, 2)."""
    is_cell = np.append(cells_inside(steps), np.False_)
    ends = []
    for axis, (u, v) in enumerate(((1, 2), (0, 2), (0, 1))):
        # The square across this axis is a face of the cells at the point and below it.
        corner = np.flatnonzero(is_cell[:-1] | is_cell[steps[:, 3 + axis]]).astype(np.int32)
        ends += [(corner, steps[steps[corner, u], v]), (steps[corner, u], steps[corner, v])]
    corner = np.flatnonzero(is_cell).astype(np.int32)
    x, y, z = steps[corner, :3].T
    ends += [(corner, steps[steps[x, 1], 2]), (y, steps[x, 2])]
    ends += [(x, steps[y, 2]), (steps[x, 1], z)]
    return np.concatenate([np.stack(pair, axis=1) for pair in ends])
