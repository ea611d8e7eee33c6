"""What is known of the cells whose inside and outside holes leave in doubt, and how to ask it.

`holes.py` finds it; `asked.py` asks about the midpoints that are left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .clusters import Clusters
from .field import ERROR, value_at
from .rays import in_space

BLOCK = 8
"""Cells along the side of the blocks that are decided as a whole, or else cell by cell."""
UNSURE = 1 << 30
"""No need: the number must be asked."""
NEED = -(1 << 20)
"""Codes of cells are NEED + need, which is negative, or the row of a leaf."""
ROUNDING = 1e-9


class Leaves(NamedTuple):
    """Blocks of cells that are not halved, though inside and outside are in doubt there.

    Parameters
    ----------
    place : array, shape (n, 3)
        The middle of each block.
    field : array, shape (n, field.SIZE)
        What caps cover around it: all of them, or all but those nearby.
    is_torn : array, shape (n,), bool
        Whether that is only right up to whole numbers.
    start : array, shape (n + 1,), int64
        The clusters of caps nearby are near[start[i]] to near[start[i + 1] - 1].
    near : array, int32
    """

    place: NDArray[np.float64]
    field: NDArray[np.float64]
    is_torn: NDArray[np.bool_]
    start: NDArray[np.int64]
    near: NDArray[np.int32]


class Doubt(NamedTuple):
    """How many crossings ahead, caps counted, it takes to be inside.

    Parameters
    ----------
    coarse : array, shape (b, b, b), int32
        The code of each block of BLOCK^3 cells; or the row of `fine`.
    fine : array, shape (u, BLOCK, BLOCK, BLOCK), int32
        The code of each cell.
    leaves : Leaves
    clusters : Clusters
        Of the caps.
    """

    coarse: NDArray[np.int32]
    fine: NDArray[np.int32]
    leaves: Leaves
    clusters: Clusters


@compiled(inline="always")
def code_at(doubt, axis, ray, cell, stop):
    """Return the code of a cell on a ray, and where it ends that cells have it.

    Only cells of the same block are looked at, and none from `stop` on.
    """
    x, y, z = in_space(axis, ray[0], ray[1], cell)
    stop = min(stop, (cell // BLOCK + 1) * BLOCK)
    code = doubt.coarse[x // BLOCK, y // BLOCK, z // BLOCK]
    if code < 0:
        return code, max(stop, cell + 1)
    block = doubt.fine[code]
    x, y, z = x % BLOCK, y % BLOCK, z % BLOCK
    code = block[x, y, z]
    until = cell + 1
    while until < stop:
        x, y, z = x + (axis == 0), y + (axis == 1), z + (axis == 2)
        if block[x, y, z] != code:
            break
        until += 1
    return code, until


@compiled(inline="always")
def in_field(leaves, leaf, p):
    """Return the value of a leaf's field at a point, and how far that may be off."""
    x, y, z = leaves.place[leaf]
    value = value_at(leaves.field[leaf], p[0] - x, p[1] - y, p[2] - z)
    return value, leaves.field[leaf, ERROR] + ROUNDING


@compiled(inline="always")
def need_between(value, error):
    """Return the next whole number above a value that may be off, or UNSURE."""
    if error >= 0.5:
        return UNSURE
    low = np.ceil(value - error)
    return np.int64(low) if low == np.ceil(value + error) else UNSURE
