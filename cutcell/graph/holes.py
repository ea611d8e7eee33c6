"""Where holes of a mesh leave inside and outside in doubt, block by block of the lattice.

With its holes capped a mesh is closed, and its winding number is the signed count chi' of
crossings ahead, a whole number. The open mesh's own number is less by what the caps cover
of the view: w = chi' - w_caps, so that

    w >= tau   <=>   chi' >= need,   need = ceil(tau + w_caps).

w_caps is small and smooth away from the holes. This file bounds it over whole blocks of
cells, see `view.py` for the proof: in most blocks `need` is one number. Around the
surfaces where it changes, w_caps is all but a polynomial over blocks of a few cells, and what
is on which side is quickly told. Only next to the rims of holes, and nearly on these surfaces,
each midpoint must be asked about by itself, see `doubt.py`. Blocks are halved from the whole
cube down to pairs of cells. What is far from a block is far from its halves, too, and kept as a
field; they, and the midpoints in them, look at the clusters nearby alone.

A block that a cap runs through is torn: w_caps jumps there, as chi' does. Its smooth part is
still a field, and a single number asked on a ray tells which whole number to add.

A mesh none of whose triangles hang together is all holes; its caps are its triangles turned
round, chi' is 0 everywhere, and all is left to the clusters.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..threads import in_threads
from .caps import Caps
from .clusters import ROOT, cluster
from .doubt import BLOCK, NEED, ROUNDING, UNSURE, Doubt, Leaves
from .field import ERROR, SIZE, change, move
from .rays import grown
from .solid_angle import between
from .view import set_apart, view

WORTH = 20
"""Midpoints in doubt for which it is worth the time to halve a block."""
LEAST = 2
"""Cells along the side of blocks that are not halved: it is no dearer to ask each midpoint."""
DEPTH = 12
"""More than blocks are ever halved."""
SPLIT = 5e-3
"""What a cluster may leave out in a block, or else it is halved."""


def find_doubt(caps: Caps, resolution: int, winding_threshold: float) -> Doubt:
    """Bound the caps' winding number over the cells of the lattice.

    Parameters
    ----------
    caps : Caps
    resolution : int
    winding_threshold : float
        tau.
    """
    clusters = cluster(caps)
    blocks = -(-resolution // BLOCK)
    coarse = np.full((blocks,) * 3, NEED + int(np.ceil(winding_threshold)), np.int32)
    corners, top = np.zeros((0, 3), np.int64), BLOCK
    if len(caps.faces):
        while 4 * top < resolution:
            top *= 2
        along = np.arange(0, resolution, top)
        corners = np.stack(np.meshgrid(along, along, along, indexing="ij"), -1).reshape(-1, 3)
    found = in_threads(
        lambda corner: _decide(clusters, resolution, winding_threshold, corner, top, coarse),
        [*corners, np.full(3, resolution)],  # the last one lies outside: never an empty list
    )
    rows = leaves = 0
    for blocks, fine, part in found:
        coarse[tuple(blocks.T)] += rows
        fine[fine >= 0] += leaves
        rows, leaves = rows + len(fine), leaves + len(part[0])
    columns = zip(*(part for *_, part in found), strict=True)
    place, field, is_torn, counts, near = (np.concatenate(column) for column in columns)
    start = np.concatenate([[0], np.cumsum(counts)])
    joined = Leaves(place, field, is_torn, start, near)
    return Doubt(coarse, np.concatenate([fine for _, fine, _ in found]), joined, clusters)


@njit(cache=True, nogil=True)
def _decide(clusters, resolution, tau, corner, top, coarse):
    """Put the codes of the blocks in a cube of `top` cells into `coarse`.

    Returns which blocks are not decided as a whole, shape (u, 3); the codes of their cells;
    and of the leaves that these name the columns, with how many clusters are near in place of
    where those start.
    """
    blocks, fine = np.empty((16, 3), np.int64), np.empty((16, BLOCK, BLOCK, BLOCK), np.int32)
    place, fields, is_torn = np.empty((64, 3)), np.empty((64, SIZE)), np.empty(64, np.bool_)
    counts, nearby, listed = np.empty(64, np.int64), np.empty(1024, np.int32), 0
    rows = leaves = 0
    waiting, count = np.empty((64, 5), np.int64), 1  # blocks: corner, size and depth
    waiting[0, :3], waiting[0, 3], waiting[0, 4] = corner, top, 1
    # Of the blocks that the present one lies in: what is far from each, and what is not.
    middle, far, field = np.zeros((DEPTH, 3)), np.zeros((DEPTH, SIZE)), np.empty(SIZE)
    near, nears = np.empty((DEPTH, len(clusters.start) - 1), np.int32), np.ones(DEPTH, np.int64)
    near[0, 0] = ROOT
    while count:
        count -= 1
        x, y, z, size, depth = waiting[count]
        if max(x, y, z) >= resolution:
            continue
        half = size / (2 * resolution)
        q = x / resolution + half, y / resolution + half, z / resolution + half
        way = between(middle[depth - 1], q)
        middle[depth, 0], middle[depth, 1], middle[depth, 2] = q
        reach = half * np.sqrt(3)
        far[depth] = far[depth - 1]
        move(far[depth], way[0], way[1], way[2])
        among = near[depth - 1, : nears[depth - 1]]
        nears[depth] = set_apart(clusters, among, far[depth], near[depth], q, reach)
        field[:] = far[depth]
        tears = view(clusters, near[depth, : nears[depth]], field, q, reach, SPLIT)
        code = _code(field, tears, half, size, tau)
        if size >= BLOCK:
            a, b, c, wide = x // BLOCK, y // BLOCK, z // BLOCK, size // BLOCK
            if code < 0:
                coarse[a : a + wide, b : b + wide, c : c + wide] = code
                continue
            if size == BLOCK:
                if rows == len(fine):
                    blocks, fine = grown(blocks), grown(fine)
                blocks[rows, 0], blocks[rows, 1], blocks[rows, 2] = a, b, c
                coarse[a, b, c] = rows
                rows += 1
        if size > BLOCK or (code == UNSURE and size > LEAST):
            for corner8 in range(8):
                child = waiting[count]
                child[0] = x + size // 2 * (corner8 >> 2)
                child[1] = y + size // 2 * (corner8 >> 1 & 1)
                child[2] = z + size // 2 * (corner8 & 1)
                child[3], child[4] = size // 2, depth + 1
                count += 1
            continue
        if code >= 0:
            if leaves == len(place):
                place, fields, is_torn = grown(place), grown(fields), grown(is_torn)
                counts = grown(counts)
            place[leaves, 0], place[leaves, 1], place[leaves, 2] = q
            fields[leaves], is_torn[leaves], counts[leaves] = field, tears, 0
            if code == UNSURE:
                fields[leaves], is_torn[leaves], counts[leaves] = far[depth], False, nears[depth]
                while listed + nears[depth] > len(nearby):
                    nearby = grown(nearby)
                nearby[listed : listed + nears[depth]] = near[depth, : nears[depth]]
                listed += nears[depth]
            code = leaves
            leaves += 1
        i, j, k = x % BLOCK, y % BLOCK, z % BLOCK
        fine[rows - 1, i : i + size, j : j + size, k : k + size] = code
    of_leaves = place[:leaves].copy(), fields[:leaves].copy(), is_torn[:leaves].copy()
    found = (*of_leaves, counts[:leaves].copy(), nearby[:listed].copy())
    return blocks[:rows].copy(), fine[:rows].copy(), found


@njit(cache=True)
def _code(field, is_torn, half, size, tau):
    """Return NEED + need of a block; or 0 if its field is to be kept; or UNSURE."""
    error = field[ERROR] + ROUNDING
    if error >= 0.5:
        return UNSURE
    slope = change(field, half)
    low = np.ceil(tau + field[0] - slope - error)
    if low == np.ceil(tau + field[0] + slope + error):
        if not is_torn:
            return NEED + np.int64(low)
    elif 3 * size**3 * min(error, slope) > WORTH * slope and size > LEAST:
        return UNSURE  # the surface that parts the block is thick: many midpoints lie in it
    return 0
