"""Lattice points deep inside the body, of which one can stand for eight."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .interior import OUTSIDE

NO_BLOCK = -1
BLOCK_POINTS = 8


def find_blocks(
    places: NDArray[np.float64], resolution: int, steps: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Find blocks of two points each way with all their neighbours inside as well.

    They are laid out from the middle of the cube, alike on either side, so that a body that is its
    own mirror image stays so.

    Parameters
    ----------
    places : array, shape (p, 3), float64
        Of the lattice points inside, in the unit cube.
    resolution : int
        R.
    steps : array, shape (p, 6) or (0, 6), int32
        See `CutCellGraph.steps`. Without rows there are no blocks.

    Returns
    -------
    array, shape (p,), int32
        The innermost point of each one's block; -1 for points in none.
    """
    return _find_blocks(places, resolution, steps)


@compiled
def _find_blocks(places, resolution, steps):
    deep = np.zeros(len(places), np.bool_)
    for p in range(len(steps)):
        deep[p] = steps[p].min() != OUTSIDE
    innermost = np.full(len(places), NO_BLOCK, np.int32)
    outward, block = np.empty(3, np.int64), np.empty(BLOCK_POINTS, np.int32)
    for p in range(len(steps)):
        begins = deep[p] and _begins_block(places[p], resolution, outward)
        if begins and _fill_block(p, steps, deep, outward, block):
            for k in range(BLOCK_POINTS):
                innermost[block[k]] = p
    return innermost


@compiled(inline="always")
def _begins_block(place, resolution, outward):
    """Tell if a block begins at a place, and write in which columns of `steps` it goes on."""
    begins = True
    for axis in range(3):
        k = int(place[axis] * resolution)
        upper = 2 * k >= resolution
        from_middle = k - (resolution + 1) // 2 if upper else resolution // 2 - 1 - k
        begins &= from_middle % 2 == 0
        outward[axis] = axis if upper else axis + 3
    return begins


@compiled(inline="always")
def _fill_block(p, steps, deep, outward, block):
    """List the points of a block, until one is not deep inside; tell if all are."""
    block[0] = p
    for k in range(1, BLOCK_POINTS):
        axis = 2 if k >= 4 else 1 if k >= 2 else 0
        block[k] = steps[block[k - (1 << axis)], outward[axis]]
        if not deep[block[k]]:
            return False
    return True
