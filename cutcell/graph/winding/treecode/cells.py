"""Classification of lattice cells: how many crossings ahead it takes to be inside.

With its holes capped a mesh is closed, and its winding number is the signed count chi of crossings
ahead, a whole number. The open mesh's own number is less by that of the caps, w = chi - w_caps, so

    w >= tau   <=>   chi >= required,   required = ceil(tau + w_caps).

Away from the holes w_caps is small and smooth. Here it is bounded over whole blocks of cells, by
the local expansions of `expansion.py`: in most blocks the required crossing count is constant.
Blocks where it is not are halved, from the whole cube down to two cells, and what remains is
ambiguous: cells near the rims of holes, and near the surfaces w_caps = k - tau. Their midpoints are
point queries, see `queries.py`. Clusters far from a block are far from its halves, too, and their
expansion is translated from block to half; only near clusters are visited again.

If no two triangles of a soup touch, the caps are the inverted triangles: chi is 0 everywhere, and
the clusters decide all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....geometry.vectors import between
from ....runtime.compiled import copy_to, no_refcount
from ....runtime.memory import check_room
from ....runtime.progress import Tell
from ....runtime.threads import in_threads
from .clusters import ROOT, Clusters
from .expansion import (
    ERROR,
    EXPANSION_SIZE,
    ROUNDING_ERROR,
    LocalExpansions,
    add_clusters,
    add_far_clusters,
    translate,
    variation,
)

BLOCK_CELLS = 8
"""Cells along the side of the blocks that are either constant or classified cell by cell."""
CONSTANT = -(1 << 20)
"""A negative class is CONSTANT + the required crossing count; others are rows of expansions."""
AMBIGUOUS = 1 << 30
"""The class of blocks that are to be halved, or that have point queries."""
CUBE_CELLS = 32
"""Cells along the side of the cubes that are classified in parallel, at most."""
SMALLEST = 2
"""Cells along the side of blocks that are not halved: the queries are no dearer."""
WORTH = 20
"""Ambiguous midpoints for which it pays to halve a block."""
SPLIT_ERROR = 5e-3
"""Clusters of a larger error in a block are split."""
COUNT = EXPANSION_SIZE + 3
"""The column of an expansion's row, after coefficients and centre, for the number of near
clusters."""
DEPTH = 12
"""More often blocks are never halved."""
MAX_NEAR = 64
"""Near clusters that a block lists. Where there are more, nearly all are near, and its queries
traverse all clusters. A separate list for each block would take gigabytes."""

UNCHECKED = 1 << 26
"""Bytes of classes for which free memory is not looked up."""


class CellClasses(NamedTuple):
    """The class of each lattice cell.

    Parameters
    ----------
    coarse : array, shape (b, b, b), int32
        The class of each block of BLOCK_CELLS^3 cells if it is constant; else the block's row of
        `fine`.
    fine : array, shape (u, BLOCK_CELLS, BLOCK_CELLS, BLOCK_CELLS), int32
        The class of each cell.
    expansions : LocalExpansions
        Of ambiguous cells.
    """

    coarse: NDArray[np.int32]
    fine: NDArray[np.int32]
    expansions: LocalExpansions


def classify_cells(
    clusters: Clusters,
    resolution: int,
    tau: float,
    report: Tell = lambda done: None,
) -> CellClasses:
    """Bound the winding number of the caps over the cells of the lattice."""
    blocks = -(-resolution // BLOCK_CELLS)
    coarse = np.full((blocks,) * 3, CONSTANT + int(np.ceil(tau)), np.int32)
    top = BLOCK_CELLS
    while 4 * top < resolution and top < CUBE_CELLS:
        top *= 2
    along = np.arange(0, resolution if len(clusters.apex) else 0, top)
    corners = np.stack(np.meshgrid(along, along, along, indexing="ij"), -1).reshape(-1, 3)
    sizes = []

    def classify(corner: NDArray[np.int64]) -> list[NDArray]:
        arrays = _buffers(top)
        counts = _classify(
            clusters, resolution, tau, corner, top, coarse, *arrays,
            _scratch(len(clusters.start) - 1),
        )  # fmt: skip
        parts = [array[:count].copy() for array, count in zip(arrays, counts, strict=True)]
        sizes.append(sum(array.nbytes for array in parts))
        if sum(sizes) > UNCHECKED:  # they are copied twice below
            check_room(2.0 * sum(sizes), "the cells near holes", "choose a lower resolution")
        return parts

    # The last corner lies outside: never an empty list.
    classified = in_threads(classify, [*corners, np.full(3, resolution)], report)
    rows = count = 0
    for corner, row, expanded, _ in classified:
        coarse[tuple(corner.T)] += rows
        row[row >= 0] += count
        rows, count = rows + len(row), count + len(expanded)
    _, fine, expanded, near = (np.concatenate(parts) for parts in zip(*classified, strict=True))
    start = np.concatenate([[0], np.cumsum(expanded[:, COUNT], dtype=np.int64)])
    columns = (0, EXPANSION_SIZE), (EXPANSION_SIZE, COUNT)
    local, centre = (np.ascontiguousarray(expanded[:, a:b]) for a, b in columns)
    return CellClasses(coarse, fine, LocalExpansions(centre, local, start, near))


def _buffers(top: int) -> list[NDArray]:
    """Return room for all that `_classify` may find in a cube of `top` cells."""
    blocks, rows = (top // BLOCK_CELLS) ** 3, (top // SMALLEST) ** 3
    return [
        np.empty((blocks, 3), np.int32),
        np.empty((blocks, BLOCK_CELLS, BLOCK_CELLS, BLOCK_CELLS), np.int32),
        np.empty((rows, COUNT + 1)),
        np.empty(rows * MAX_NEAR, np.int32),
    ]


class _Scratch(NamedTuple):
    """What `_classify` remembers: the blocks that wait, and of each ancestor of the current block.

    Parameters
    ----------
    waiting : array, shape (8 DEPTH, 5), int64
        Corner, size and depth.
    centre : array, shape (DEPTH, 3)
    far : array, shape (DEPTH, EXPANSION_SIZE)
        The expansion of far clusters.
    near : array, shape (DEPTH, m), int32
        The first nears[i] entries are the near clusters.
    nears : array, shape (DEPTH,), int64
    local : array, shape (EXPANSION_SIZE,)
    """

    waiting: NDArray[np.int64]
    centre: NDArray[np.float64]
    far: NDArray[np.float64]
    near: NDArray[np.int32]
    nears: NDArray[np.int64]
    local: NDArray[np.float64]


def _scratch(leaves: int) -> _Scratch:
    near = np.empty((DEPTH, leaves), np.int32)
    near[0, 0] = ROOT
    return _Scratch(
        np.empty((8 * DEPTH, 5), np.int64), np.zeros((DEPTH, 3)), np.zeros((DEPTH, EXPANSION_SIZE)),
        near, np.ones(DEPTH, np.int64), np.empty(EXPANSION_SIZE),
    )  # fmt: skip


@no_refcount
def _classify(
    clusters, resolution, tau, corner, top, coarse, blocks, fine, expanded, all_near, scratch
):
    """Write the classes of the blocks in a cube of `top` cells into `coarse`.

    Fills in which blocks are not constant, shape (u, 3); the classes of their cells; the rows of
    expansions that these name: coefficients, centre, COUNT; and the near clusters. Returns how many
    there are of each.
    """
    waiting, centre, far, near, nears, local = scratch
    rows = stored = listed = 0
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = corner[0], corner[1], corner[2]
    waiting[0, 3], waiting[0, 4] = top, 1
    count = 1
    while count:
        count -= 1
        x, y, z = waiting[count, 0], waiting[count, 1], waiting[count, 2]
        size, depth = waiting[count, 3], waiting[count, 4]
        if max(x, y, z) >= resolution:
            continue
        half = size / (2 * resolution)
        q = x / resolution + half, y / resolution + half, z / resolution + half
        reach = half * np.sqrt(3)
        shift = between(centre[depth - 1], q)
        centre[depth, 0], centre[depth, 1], centre[depth, 2] = q
        copy_to(far[depth - 1], far[depth])
        translate(far[depth], shift[0], shift[1], shift[2])
        among = near[depth - 1, : nears[depth - 1]]
        nears[depth] = add_far_clusters(clusters, among, far[depth], near[depth], q, reach)
        close = near[depth, : nears[depth]]
        copy_to(far[depth], local)
        add_clusters(clusters, close, local, q, reach, SPLIT_ERROR)
        cell_class = _class_of(local, half, size, tau)
        a, b, c = x // BLOCK_CELLS, y // BLOCK_CELLS, z // BLOCK_CELLS
        if size >= BLOCK_CELLS and cell_class < 0:
            _fill(coarse, a, b, c, size // BLOCK_CELLS, cell_class)
            continue
        if size == BLOCK_CELLS:
            blocks[rows, 0], blocks[rows, 1], blocks[rows, 2] = a, b, c
            coarse[a, b, c] = rows
            rows += 1
        if size > BLOCK_CELLS or (cell_class == AMBIGUOUS and size > SMALLEST):
            size //= 2
            for k in range(8):
                half_block = waiting[count + k]
                half_block[0], half_block[1] = x + size * (k >> 2), y + size * (k >> 1 & 1)
                half_block[2], half_block[3], half_block[4] = z + size * (k & 1), size, depth + 1
            count += 8
            continue
        if cell_class >= 0:
            row = expanded[stored]
            level = depth if len(close) <= MAX_NEAR else 0  # at 0 are all clusters, and no far ones
            copy_to(far[level] if cell_class == AMBIGUOUS else local, row)
            row[EXPANSION_SIZE], row[EXPANSION_SIZE + 1], row[EXPANSION_SIZE + 2] = q
            row[COUNT] = 0
            if cell_class == AMBIGUOUS:
                row[COUNT] = nears[level]
                for k in range(nears[level]):
                    all_near[listed + k] = near[level, k]
                listed += nears[level]
            cell_class = stored
            stored += 1
        _fill(fine[rows - 1], x % BLOCK_CELLS, y % BLOCK_CELLS, z % BLOCK_CELLS, size, cell_class)
    return rows, rows, stored, listed


@no_refcount
def _fill(grid, x, y, z, size, value):
    """Write a value into a cube of a grid, as far as it lies in the grid."""
    for i in range(x, min(x + size, grid.shape[0])):
        for j in range(y, min(y + size, grid.shape[1])):
            for k in range(z, min(z + size, grid.shape[2])):
                grid[i, j, k] = value


@no_refcount
def _class_of(local, half, size, tau):
    """Return the class of a constant block; AMBIGUOUS; or 0 if its expansion decides queries."""
    error = local[ERROR] + ROUNDING_ERROR
    if error >= 0.5:
        return AMBIGUOUS
    slope = variation(local, half)
    required = np.ceil(tau + local[0] - slope - error)
    if required == np.ceil(tau + local[0] + slope + error):
        return CONSTANT + np.int64(required)
    # About error / slope of the midpoints on three axes are closer to the threshold than the error.
    if 3 * size**3 * min(error, slope) > WORTH * slope and size > SMALLEST:
        return AMBIGUOUS
    return 0
