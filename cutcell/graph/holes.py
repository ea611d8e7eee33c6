"""Where holes of a mesh leave inside and outside in doubt, block by block of the lattice.

With its holes capped a mesh is closed, and its winding number is the signed count chi' of
crossings ahead, a whole number. The open mesh's own number is less by what the caps cover
of the view: w = chi' - w_caps, so that

    w >= tau   <=>   chi' >= need,   need = ceil(tau + w_caps).

w_caps is small and smooth away from the holes. This file bounds it over whole blocks of
cells, see `clusters.py` for the proof: in most blocks `need` is one number. Around the
surfaces where it changes, w_caps is as good as linear over blocks of a few cells, and what
is on which side of a plane is quickly told. Only next to the rims of holes, and nearly on
these surfaces, the winding number itself must be asked.

A block that a cap runs through is torn: w_caps jumps there, as chi' does. Its smooth part is
still as good as linear, and a single number asked on a ray tells which whole number to add.

A mesh none of whose triangles hang together is all holes; its caps are its triangles turned
round, chi' is 0 everywhere, and all is left to the clusters.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..threads import in_threads, parts
from .caps import Caps
from .clusters import Clusters, cluster, view

BLOCK = 8
"""Cells along the side of the blocks that are decided as a whole, or else cell by cell."""
WORTH = 20
"""Midpoints in doubt for which it is worth the time to halve a block."""
TOLERANCE = 0.004
"""What one cluster may leave out of a block's bound."""
UNSURE = 1 << 30
"""Codes: from here on, where the number must be asked; from 0 on, rows of leaves; below,
NEED + need."""
NEED = -(1 << 20)
ROUNDING = 1e-9


class Doubt(NamedTuple):
    """How many crossings ahead, caps counted, it takes to be inside.

    Parameters
    ----------
    coarse : array, shape (b, b, b), int32
        For each block of BLOCK^3 cells NEED + need; or the row of `fine`.
    fine : array, shape (u, BLOCK, BLOCK, BLOCK), int32
        For each cell NEED + need; or the row of `planes`; or UNSURE.
    planes : array, shape (p, 9)
        Of blocks where w_caps is as good as linear: a place, w_caps there, its gradient,
        how far it may be from that, and whether the block is torn.
    """

    coarse: NDArray[np.int32]
    fine: NDArray[np.int32]
    planes: NDArray[np.float64]


def find_doubt(caps: Caps, resolution: int, winding_threshold: float) -> tuple[Doubt, Clusters]:
    """Bound the caps' winding number over the cells of the lattice.

    Parameters
    ----------
    caps : Caps
    resolution : int
    winding_threshold : float
        tau.

    Returns
    -------
    Doubt
    Clusters
        Of the caps.
    """
    clusters = cluster(caps)
    blocks = -(-resolution // BLOCK)
    coarse = np.full((blocks,) * 3, NEED + int(np.ceil(winding_threshold)), np.int32)
    fine, planes = np.empty((0, BLOCK, BLOCK, BLOCK), np.int32), np.empty((0, 9))
    if len(caps.faces) == 0:
        return Doubt(coarse, fine, planes), clusters
    top = BLOCK
    while 4 * top < resolution:
        top *= 2
    along = np.arange(0, resolution, top)
    corners = np.stack(np.meshgrid(along, along, along, indexing="ij"), -1).reshape(-1, 3)
    in_threads(
        lambda k: _decide_blocks(clusters, resolution, winding_threshold, top, corners[k], coarse),
        range(len(corners)),
    )
    unsure = np.ascontiguousarray(np.argwhere(coarse == UNSURE))
    if len(unsure) == 0:
        return Doubt(coarse, fine, planes), clusters
    fine = np.full((len(unsure), BLOCK, BLOCK, BLOCK), UNSURE, np.int32)
    pieces = parts(len(unsure), len(unsure) // 8 + 1)
    found = in_threads(
        lambda part: _refine_blocks(
            clusters, resolution, winding_threshold, unsure[part], fine[part]
        ),
        pieces,
    )
    first = 0
    for part, rows in zip(pieces, found, strict=True):
        of_plane = (fine[part] >= 0) & (fine[part] < UNSURE)
        fine[part][of_plane] += first
        first += len(rows)
    coarse[tuple(unsure.T)] = np.arange(len(unsure))
    return Doubt(coarse, fine, np.concatenate(found)), clusters


@njit(cache=True, nogil=True)
def _decide_blocks(clusters, resolution, tau, top, corner, coarse):
    """Put the need of each block in a cube of `top` cells into `coarse`, or UNSURE."""
    stack = np.empty((64, 4), np.int64)
    stack[0, :3], stack[0, 3], count = corner, top, 1
    plane = np.empty(9)
    while count:
        count -= 1
        x, y, z, size = stack[count]
        if max(x, y, z) >= resolution:
            continue
        code = _look(clusters, resolution, tau, x, y, z, size, plane)
        if code < 0 or size == BLOCK:
            a, b, c, wide = x // BLOCK, y // BLOCK, z // BLOCK, size // BLOCK
            coarse[a : a + wide, b : b + wide, c : c + wide] = code if code < 0 else UNSURE
            continue
        half = size // 2
        for corner8 in range(8):
            stack[count, 0] = x + half * (corner8 >> 2)
            stack[count, 1] = y + half * (corner8 >> 1 & 1)
            stack[count, 2] = z + half * (corner8 & 1)
            stack[count, 3] = half
            count += 1


@njit(cache=True, nogil=True)
def _refine_blocks(clusters, resolution, tau, unsure, fine):
    """Put a code for each cell of unsure blocks into `fine`; return the planes."""
    planes, count = np.empty((16, 9)), 0
    stack = np.empty((64, 4), np.int64)
    for u in range(len(unsure)):
        corner = unsure[u] * BLOCK
        stack[0, :3], stack[0, 3], waiting = 0, BLOCK, 1
        while waiting:
            waiting -= 1
            x, y, z, size = stack[waiting]
            if count == len(planes):
                larger = np.empty((2 * count, 9))
                larger[:count] = planes
                planes = larger
            plane = planes[count]
            code = _look(
                clusters, resolution, tau, corner[0] + x, corner[1] + y, corner[2] + z, size, plane
            )
            if code == UNSURE and size > 1:
                half = size // 2
                for corner8 in range(8):
                    stack[waiting, 0] = x + half * (corner8 >> 2)
                    stack[waiting, 1] = y + half * (corner8 >> 1 & 1)
                    stack[waiting, 2] = z + half * (corner8 & 1)
                    stack[waiting, 3] = half
                    waiting += 1
                continue
            if code == 0:
                code = count
                count += 1
            fine[u, x : x + size, y : y + size, z : z + size] = code
    return planes[:count].copy()


@njit(cache=True)
def _look(clusters, resolution, tau, x, y, z, size, plane):
    """Return NEED + need of a block; or 0 and its plane; or UNSURE."""
    half = size / (2 * resolution)
    q = x / resolution + half, y / resolution + half, z / resolution + half
    value, gradient, error, is_torn = view(clusters, q, half * np.sqrt(3), TOLERANCE, 0.5)
    error += ROUNDING
    if error >= 0.5:
        return UNSURE
    slope = half * (abs(gradient[0]) + abs(gradient[1]) + abs(gradient[2]))
    low = np.ceil(tau + value - slope - error)
    if low == np.ceil(tau + value + slope + error):
        if not is_torn:
            return NEED + np.int64(low)
    elif 3 * size**3 * min(error, slope) > WORTH * slope and size > 1:
        return UNSURE  # the plane that parts the block is thick: many midpoints lie in it
    plane[0], plane[1], plane[2] = q
    plane[3], plane[7], plane[8] = value, error, is_torn
    plane[4], plane[5], plane[6] = gradient
    return 0


@njit(cache=True, inline="always")
def code_at(doubt, cell):
    """Return the code of a cell, and whether its whole block has the same."""
    x, y, z = cell
    code = doubt.coarse[x // BLOCK, y // BLOCK, z // BLOCK]
    if code < 0:
        return code, True
    return doubt.fine[code, x % BLOCK, y % BLOCK, z % BLOCK], False


@njit(cache=True, inline="always")
def on_plane(doubt, code, p):
    """Return w_caps at a point in a cell with that code, and how far it may be off."""
    q = doubt.planes[code]
    value = q[3] + q[4] * (p[0] - q[0]) + q[5] * (p[1] - q[1]) + q[6] * (p[2] - q[2])
    return value, q[7]


@njit(cache=True)
def need_at(clusters, p, tau):
    """Return the need at a point, or UNSURE if only an exact sum can tell."""
    for tolerance in (2e-3, 1e-4, 1e-6):
        value, _, error, _ = view(clusters, p, 0.0, tolerance, 0.5)
        if error == np.inf:
            break
        need = need_between(tau + value, error + ROUNDING)
        if need < UNSURE:
            return need
    return UNSURE


@njit(cache=True, inline="always")
def need_between(value, error):
    """Return the next whole number above a value that may be off, or UNSURE."""
    low = np.ceil(value - error)
    return np.int64(low) if low == np.ceil(value + error) else UNSURE
