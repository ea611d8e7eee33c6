"""What is known of the cells whose inside and outside holes leave in doubt, and how to ask it.

`holes.py` finds it. Here a midpoint is asked about: first the field of the block that it lies
in, then the clusters of caps nearby, then all, as closely as it takes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..compiled import lean
from .clusters import ROOT, Clusters
from .field import ERROR, value_at
from .view import covered

BLOCK = 8
"""Cells along the side of the blocks that are decided as a whole, or else cell by cell."""
UNSURE = 1 << 30
"""No need: the number must be asked."""
NEED = -(1 << 20)
"""Codes of cells are NEED + need, which is negative, or the row of a leaf."""
ROUNDING = 1e-9
NEAR = 3e-2, 3e-3
"""What a cluster nearby may leave out at a midpoint: less if the bound is not enough."""
ALL = 3e-3, 1e-4, 1e-6, 1e-8
"""The same for any cluster, where what is far leaves out too much."""


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


@njit(cache=True, inline="always")
def code_at(doubt, cell):
    """Return the code of a cell, and whether its whole block has the same."""
    x, y, z = cell
    code = doubt.coarse[x // BLOCK, y // BLOCK, z // BLOCK]
    if code < 0:
        return code, True
    return doubt.fine[code, x % BLOCK, y % BLOCK, z % BLOCK], False


@njit(cache=True, inline="always")
def in_field(leaves, leaf, p):
    """Return the value of a leaf's field at a point, and how far that may be off."""
    x, y, z = leaves.place[leaf]
    value = value_at(leaves.field[leaf], p[0] - x, p[1] - y, p[2] - z)
    return value, leaves.field[leaf, ERROR] + ROUNDING


@lean
def need_in(doubt, leaf, p, tau):
    """Return the need at a point of a leaf, or UNSURE if only an exact sum can tell."""
    leaves, clusters = doubt.leaves, doubt.clusters
    near = leaves.near[leaves.start[leaf] : leaves.start[leaf + 1]]
    if not leaves.is_torn[leaf]:
        known, off = in_field(leaves, leaf, p)
        for tolerance in NEAR:
            value, error = covered(clusters, near, p, tolerance)
            need = need_between(tau + known + value, off + error)
            if need < UNSURE:
                return need
    for tolerance in ALL:
        value, error = covered(clusters, (ROOT,), p, tolerance)
        need = need_between(tau + value, error + ROUNDING)
        if need < UNSURE:
            return need
    return UNSURE


@njit(cache=True, inline="always")
def need_between(value, error):
    """Return the next whole number above a value that may be off, or UNSURE."""
    if error >= 0.5:
        return UNSURE
    low = np.ceil(value - error)
    return np.int64(low) if low == np.ceil(value + error) else UNSURE
