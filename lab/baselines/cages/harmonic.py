"""Harmonic coordinates of a cage, on a grid inside it (Joshi et al. 2007)."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.linalg import cg
from scipy.spatial import cKDTree

from cutcell.isolated.run import WorkFailedError

from ..volumes.voxels import mark_triangles

MARGIN = 2
"""Cells around the cage."""
ACCURACY = 1e-4
"""Relative tolerance of the solution."""


def harmonic_values(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    points: NDArray[np.float64],
    values: NDArray[np.float64],
    resolution: int,
) -> NDArray[np.float64]:
    """Carry values from a cage's vertices to points inside, by their harmonic coordinates.

    On the cage the values are linear in each triangle; inside they have no Laplacian. All
    columns are solved for instead of one coordinate for each vertex: the same, with less work.

    Shapes: vertices (c, 3), faces (m, 3), points (n, 3), values (c, j); returns (n, j).
    """
    origin = vertices.min(axis=0) - MARGIN / resolution
    shape = np.ceil((vertices.max(axis=0) - origin) * resolution).astype(int) + MARGIN
    border = np.zeros((int(shape.max()),) * 3, bool)
    mark_triangles((vertices[faces] - origin) * resolution, border)
    region = label(~border)[0]
    inside = ~border & (region != region[0, 0, 0])
    cells = np.argwhere(border)
    where, at_border = _sampled(vertices, faces, values, 0.5 / resolution)
    nearest = cKDTree(where).query(origin + (cells + 0.5) / resolution)[1]
    number = np.full(border.shape, -1)
    count = int(inside.sum())
    number[inside] = np.arange(count)
    number[border] = count + np.arange(len(cells))
    border_values = at_border[nearest]
    field = np.concatenate([_solve(number, inside, border_values), border_values])
    return _interpolate(number, field, (points - origin) * resolution - 0.5)


def _sampled(
    vertices: NDArray, faces: NDArray, values: NDArray, spacing: float
) -> tuple[NDArray, NDArray]:
    """Spread points over triangles, no farther apart than `spacing`; with their values."""
    where, sampled = [], []
    corners = vertices[faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    counts = np.ceil(longest / spacing).astype(int)
    for n in np.unique(counts):
        equal = faces[counts == n]
        spots = [(i, j, n - i - j) for i, j in product(range(n + 1), repeat=2) if i + j <= n]
        share = np.array(spots) / n
        where.append(np.einsum("sc,mcx->msx", share, vertices[equal]).reshape(-1, 3))
        sampled.append(np.einsum("sc,mcx->msx", share, values[equal]).reshape(-1, values.shape[1]))
    return np.concatenate(where), np.concatenate(sampled)


def _solve(number: NDArray, inside: NDArray, border_values: NDArray) -> NDArray[np.float64]:
    """Make each cell inside the mean of its six neighbours; `known` are those of the border."""
    count = int(inside.sum())
    cells = np.argwhere(inside)
    rows, columns = [], []
    for axis, step in product(range(3), (-1, 1)):
        neighbours = cells.copy()
        neighbours[:, axis] += step
        rows.append(np.arange(count))
        columns.append(number[tuple(neighbours.T)])
    row, column = np.concatenate(rows), np.concatenate(columns)
    free = column < count
    one = np.ones(len(row))
    matrix = coo_array((-one[free], (row[free], column[free])), shape=(count, count)).tocsr()
    matrix.setdiag(6.0)
    shape = (count, len(border_values))
    outer = coo_array((one[~free], (row[~free], column[~free] - count)), shape=shape).tocsr()
    right = outer @ border_values
    solution = np.zeros_like(right)
    for column_ in np.flatnonzero(right.any(axis=0)):
        solution[:, column_], failed = cg(matrix, right[:, column_], rtol=ACCURACY)
        if failed:
            raise WorkFailedError("the harmonic equations could not be solved")
    return solution


def _interpolate(number: NDArray, field: NDArray, points: NDArray) -> NDArray[np.float64]:
    """Take the values at points between the centres of cells, of those that have one."""
    low = np.floor(points).astype(int)
    part = points - low
    total, weighted = np.zeros(len(points)), np.zeros((len(points), field.shape[1]))
    for corner in product((0, 1), repeat=3):
        cell = np.clip(low + corner, 0, np.array(number.shape) - 1)
        index = number[tuple(cell.T)]
        share = np.where(corner, part, 1 - part).prod(axis=1) * (index >= 0)
        total += share
        weighted += share[:, None] * field[index]
    return np.divide(
        weighted, total[:, None], out=np.full_like(weighted, np.nan), where=total[:, None] > 0
    )
