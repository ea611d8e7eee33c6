"""Edges inside the body: kept segments, and diagonals of cells that lie inside altogether."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

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
    whole: NDArray[np.bool_],
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
    whole : array, shape (p,), bool
        Set true for each interior point whose segment to the next point along the axis
        is kept and not crossed.
    """
    run = runs.ray, runs.first, runs.last, runs.low, runs.high, run_start
    place = points.resolution, axis, first_point
    _fill_edges(place, run, points.table, ends, edges, lengths, whole)


@njit(cache=True, nogil=True)
def _edge_starts(first, last, low, high, start):
    starts = np.empty(len(first) + 1, np.int64)
    starts[0] = start
    for r in range(len(first)):
        stops = last[r] - first[r] + 1 + (low[r] != NONE) + (high[r] != NONE)
        starts[r + 1] = starts[r] + stops - 1
    return starts


@njit(cache=True, nogil=True)
def _fill_edges(place, runs, table, ends, edges, lengths, whole):
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
            if before != OUTSIDE:
                whole[before] = True
            if here != NONE:
                edges[e, 0], edges[e, 1] = here, first_point + point
                lengths[e] = (k + 0.5) / resolution - at
                e += 1
            here, before, at = first_point + point, point, (k + 0.5) / resolution
        if high[r] != NONE:
            edges[e, 0], edges[e, 1] = here, crossing_node[high[r]]
            lengths[e] = position[high[r]] - at


def diagonal_edges(
    points: InteriorPoints, first_point: int, whole: NDArray[np.bool_]
) -> NDArray[np.int32]:
    """List the face and body diagonals of cells whose twelve edges are whole.

    Parameters
    ----------
    points : InteriorPoints
    first_point : int
        The node of the first interior point.
    whole : array, shape (3, p), bool
        See `segment_edges`, for x, y and z.

    Returns
    -------
    array, shape (d, 2), int32
        Each diagonal once, also where two cells share it.
    """
    cell = np.zeros(len(points), np.bool_)
    _mark_cells(points.resolution, *points.table, whole, cell)
    counts = np.zeros(points.resolution**2 + 1, np.int64)
    nothing = np.empty((0, 2), np.int32)
    _list_diagonals(points.resolution, *points.table, cell, first_point, counts[1:], nothing)
    start = np.cumsum(counts)
    edges = np.empty((start[-1], 2), np.int32)
    _list_diagonals(points.resolution, *points.table, cell, first_point, start[:-1].copy(), edges)
    return edges


@njit(cache=True, inline="always")
def _at(resolution, start, first, last, number, x, y, z):
    if not (0 <= x < resolution and 0 <= y < resolution and 0 <= z < resolution):
        return np.int64(OUTSIDE)
    return point_number(start, first, last, number, x * resolution + y, z)


@njit(cache=True)
def _mark_cells(resolution, start, first, last, number, whole, cell):
    """Mark the points that are the lowest corner of a cell inside."""
    for column in range(resolution * resolution):
        x, y = column // resolution, column % resolution
        for s in range(start[column], start[column + 1]):
            for z in range(first[s], last[s] + 1):
                inside = True
                for corner in range(7):  # the eighth starts no edge of the cell
                    dx, dy, dz = corner >> 2, corner >> 1 & 1, corner & 1
                    p = _at(resolution, start, first, last, number, x + dx, y + dy, z + dz)
                    if p == OUTSIDE or not (
                        (dx or whole[0, p]) and (dy or whole[1, p]) and (dz or whole[2, p])
                    ):
                        inside = False
                        break
                cell[number[s] + z - first[s]] = inside


@njit(cache=True)
def _list_diagonals(resolution, start, first, last, number, cell, first_point, cursor, edges):
    """Count the diagonals that start in each column in `cursor`; or list them."""
    for column in range(resolution * resolution):
        x, y = column // resolution, column % resolution
        for s in range(start[column], start[column + 1]):
            for z in range(first[s], last[s] + 1):
                p = number[s] + z - first[s]
                for axis in range(3):
                    # The square from p across this axis borders the cells at p and below.
                    below = _at(
                        resolution,
                        start,
                        first,
                        last,
                        number,
                        x - (axis == 0),
                        y - (axis == 1),
                        z - (axis == 2),
                    )
                    if not (cell[p] or (below != OUTSIDE and cell[below])):
                        continue
                    ux, uy, uz = np.int64(axis != 0), np.int64(axis == 0), 0
                    vx, vy, vz = 0, np.int64(axis == 2), np.int64(axis != 2)
                    u = _at(resolution, start, first, last, number, x + ux, y + uy, z + uz)
                    v = _at(resolution, start, first, last, number, x + vx, y + vy, z + vz)
                    w = _at(
                        resolution,
                        start,
                        first,
                        last,
                        number,
                        x + ux + vx,
                        y + uy + vy,
                        z + uz + vz,
                    )
                    _add(edges, cursor, column, first_point, p, w)
                    _add(edges, cursor, column, first_point, u, v)
                if cell[p]:
                    for corner in range(4):
                        dx, dy = corner >> 1, corner & 1
                        a = _at(resolution, start, first, last, number, x + dx, y + dy, z)
                        b = _at(
                            resolution, start, first, last, number, x + 1 - dx, y + 1 - dy, z + 1
                        )
                        _add(edges, cursor, column, first_point, a, b)


@njit(cache=True, inline="always")
def _add(edges, cursor, column, first_point, a, b):
    if len(edges):
        edges[cursor[column], 0] = first_point + a
        edges[cursor[column], 1] = first_point + b
    cursor[column] += 1
