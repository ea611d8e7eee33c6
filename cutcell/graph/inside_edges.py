"""Edges inside the body: kept segments, and diagonals of cells that lie inside altogether."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .interior import OUTSIDE, InteriorPoints, place_on_ray, point_number
from .segments import NONE, Runs


def edge_starts(runs: Runs, first: int) -> NDArray[np.int64]:
    """Return where the edges of each run begin, and of all end, shape (r + 1,)."""
    return _edge_starts(runs.first, runs.last, runs.low, runs.high, first)


def fill_edges(
    runs: Runs,
    run_start: NDArray[np.int64],
    axis: int,
    points: InteriorPoints,
    first_point: int,
    ends: tuple[NDArray[np.float64], NDArray[np.int32]],
    edges: NDArray[np.int32],
    lengths: NDArray[np.float64],
    steps: NDArray[np.int32],
) -> None:
    """List the kept segments along one axis as edges.

    Parameters
    ----------
    runs : Runs
    run_start : array, shape (r + 1,)
        See `edge_starts`.
    axis : int
    points : InteriorPoints
    first_point : int
        The node of the first interior point.
    ends : tuple of two arrays, shape (c,)
        Positions of the axis' crossings, and their nodes.
    edges, lengths : arrays, shapes (e, 2) and (e,)
        Written to.
    steps : array, shape (p, 6) or (0, 6), int32
        Gets the interior points next to each where the segment between is kept and not
        crossed: upward along the axis, and 3 columns further downward.
    """
    run = runs.ray, runs.first, runs.last, runs.low, runs.high, run_start
    place = points.resolution, axis, first_point
    _fill_edges(place, run, points.table, ends, edges, lengths, steps)


@compiled
def _edge_starts(first, last, low, high, start):
    starts = np.empty(len(first) + 1, np.int64)
    starts[0] = start
    for r in range(len(first)):
        stops = last[r] - first[r] + 1 + (low[r] != NONE) + (high[r] != NONE)
        starts[r + 1] = starts[r] + stops - 1
    return starts


@compiled
def _fill_edges(place, runs, table, ends, edges, lengths, steps):
    resolution, axis, first_point = place
    ray, first, last, low, high, start = runs
    position, crossing_node = ends
    for r in range(len(ray)):
        e = start[r]
        here, before, at = NONE, OUTSIDE, 0.0  # the last stop: its node, its point, its place
        if low[r] != NONE:
            here, at = crossing_node[low[r]], position[low[r]]
        for k in range(first[r], last[r] + 1):
            column, z = place_on_ray(axis, ray[r], k, resolution)
            point = point_number(table[0], table[1], table[2], table[3], column, z)
            if before != OUTSIDE and len(steps):
                steps[before, axis], steps[point, 3 + axis] = point, before
            if here != NONE:
                edges[e, 0], edges[e, 1] = here, first_point + point
                lengths[e] = (k + 0.5) / resolution - at
                e += 1
            here, before, at = first_point + point, point, (k + 0.5) / resolution
        if high[r] != NONE:
            edges[e, 0], edges[e, 1] = here, crossing_node[high[r]]
            lengths[e] = position[high[r]] - at


def diagonal_edges(steps: NDArray[np.int32], first_point: int) -> NDArray[np.int32]:
    """List the face and body diagonals of cells all of whose twelve edges lie inside.

    Parameters
    ----------
    steps : array, shape (p, 6), int32
        See `fill_edges`, for x, y and z.
    first_point : int
        The node of the first interior point.

    Returns
    -------
    array, shape (d, 2), int32
        Each diagonal once, also where two cells share it.
    """
    cell = _mark_cells(steps)
    edges = np.empty((0, 2), np.int32)
    edges = np.empty((_list_diagonals(steps, cell, first_point, edges), 2), np.int32)
    _list_diagonals(steps, cell, first_point, edges)
    return edges


@compiled(inline="always")
def _step(steps, point, column):
    """Return the next point, OUTSIDE if there is none or the point is none."""
    return steps[point, column] if point != OUTSIDE else OUTSIDE


@compiled
def _mark_cells(steps):
    """Mark the points that are the lowest corner of a cell inside."""
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
    """Count the diagonals; and list them where there is room."""
    count = 0
    for p in range(len(steps)):
        for axis in range(3):
            # The square from p across this axis borders the cells at p and below.
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
