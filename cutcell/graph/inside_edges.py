"""Edges inside the body: kept segments, and the diagonals of cells that lie entirely inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import compiled
from .interior import OUTSIDE, InteriorPoints, point_number, point_on_ray
from .segments import NONE, InsideIntervals


def edge_starts(inside: InsideIntervals, first: int) -> NDArray[np.int64]:
    """Return the first edge of each interval, counted from `first`, and the end, shape (r + 1,)."""
    return _edge_starts(inside.first, inside.last, inside.low, inside.high, first)


def fill_edges(
    inside: InsideIntervals,
    start: NDArray[np.int64],
    axis: int,
    points: InteriorPoints,
    first_point: int,
    ends: tuple[NDArray[np.float64], NDArray[np.int32]],
    edges: NDArray[np.int32],
    lengths: NDArray[np.float64],
) -> None:
    """List the kept segments along one axis as edges.

    Shapes: start (r + 1,), ends (c,).
    """
    intervals = inside.ray, inside.first, inside.last, inside.low, inside.high, start
    where = points.resolution, axis, first_point
    _fill_edges(where, intervals, points.table, ends, edges, lengths)


@compiled
def _edge_starts(first, last, low, high, start):
    starts = np.empty(len(first) + 1, np.int64)
    starts[0] = start
    for r in range(len(first)):
        stops = last[r] - first[r] + 1 + (low[r] != NONE) + (high[r] != NONE)
        starts[r + 1] = starts[r] + stops - 1
    return starts


@compiled
def _fill_edges(where, intervals, table, ends, edges, lengths):
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
    """List the neighbours of interior points along the axes.

    Shapes: nodes (N, 3), edges (e, 2); returns (last - first, 6).
    """
    return _lattice_steps(nodes, edges, first, last)


@compiled
def _lattice_steps(nodes, edges, first, last):
    steps = np.full((last - first, 6), OUTSIDE, np.int32)
    for e in range(len(edges)):
        low, high = edges[e, 0], edges[e, 1]
        if min(low, high) >= first and max(low, high) < last:
            for axis in range(3):
                if nodes[low, axis] < nodes[high, axis]:
                    steps[low - first, axis], steps[high - first, 3 + axis] = (
                        high - first,
                        low - first,
                    )
    return steps


def diagonal_edges(steps: NDArray[np.int32], first_point: int) -> NDArray[np.int32]:
    """List the face and body diagonals of cells whose twelve edges all lie inside.

    Shapes: steps (p, 6); returns (d, 2).
    """
    cell = _mark_cells(steps)
    edges = np.empty((0, 2), np.int32)
    edges = np.empty((_list_diagonals(steps, cell, first_point, edges), 2), np.int32)
    _list_diagonals(steps, cell, first_point, edges)
    return edges


def cells_inside(steps: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Return which interior points are the lowest corner of a cell whose twelve edges lie inside.

    `steps` as of `lattice_steps`; shape (p,).
    """
    return _mark_cells(steps)


@compiled(inline="always")
def _step(steps, point, column):
    """Return the neighbour of a point, OUTSIDE if it has none or is itself outside."""
    return steps[point, column] if point != OUTSIDE else OUTSIDE


@compiled
def _mark_cells(steps):
    """Mark the points that are the lowest corner of a cell that lies inside."""
    cell = np.empty(len(steps), np.bool_)
    for p in range(len(steps)):
        x, y, z = steps[p, 0], steps[p, 1], steps[p, 2]
        xy, yz, zx = _step(steps, x, 1), _step(steps, y, 2), _step(steps, z, 0)
        inside = xy != OUTSIDE and yz != OUTSIDE and zx != OUTSIDE
        inside = inside and xy == _step(steps, y, 0) and yz == _step(steps, z, 1)
        inside = inside and zx == _step(steps, x, 2) and steps[xy, 2] != OUTSIDE
        cell[p] = inside and steps[xy, 2] == steps[yz, 0] == steps[zx, 1]
    return cell


@compiled
def _list_diagonals(steps, cell, first_point, edges):
    """Count the diagonals; list them if `edges` has rows."""
    count = 0
    for p in range(len(steps)):
        for axis in range(3):
            # The square at p across this axis is a face of the cells at p and below.
            below = steps[p, 3 + axis]
            if cell[p] or (below != OUTSIDE and cell[below]):
                u, v = steps[p, 0 if axis else 1], steps[p, 1 if axis == 2 else 2]
                count = _add(edges, count, first_point, p, steps[u, 1 if axis == 2 else 2])
                count = _add(edges, count, first_point, u, v)
        if cell[p]:
            x, y, z = steps[p, 0], steps[p, 1], steps[p, 2]
            top = steps[steps[x, 1], 2]
            count = _add(edges, count, first_point, p, top)
            count = _add(edges, count, first_point, y, steps[x, 2])
            count = _add(edges, count, first_point, x, steps[y, 2])
            count = _add(edges, count, first_point, steps[x, 1], z)
    return count


@compiled(inline="always")
def _add(edges, count, first_point, a, b):
    if len(edges):
        edges[count, 0], edges[count, 1] = first_point + a, first_point + b
    return count + 1
