"""Where holes of a mesh leave inside and outside in doubt, block by block of the lattice.

With its holes capped a mesh is closed, and its winding number is the signed count chi' of
crossings ahead, a whole number. The open mesh's own number is less by what the caps cover
of the view: w = chi' - w_caps, so that

    w >= tau   <=>   chi' >= need,   need = ceil(tau + w_caps).

w_caps is small and smooth away from the holes. This file bounds it over whole blocks of
cells, see `view.py` for the proof: in most blocks `need` is one number. Around the
surfaces where it changes, w_caps is all but a polynomial over blocks of a few cells, and what
is on which side is quickly told. Only next to the rims of holes, and nearly on these surfaces,
midpoints must be asked about, see `asked.py`. Blocks are halved from the whole
cube down to pairs of cells. What is far from a block is far from its halves, too, and kept as a
field; they, and the midpoints in them, look at the clusters nearby alone.

A block that a cap runs through is torn: w_caps jumps there, as chi' does. Its smooth part is
still a field, and a single number asked on a ray tells which whole number to add.

A mesh none of whose triangles hang together is all holes; its caps are its triangles turned
round, chi' is 0 everywhere, and all is left to the clusters.
"""

from __future__ import annotations

import numpy as np

from ..compiled import compiled, put
from ..progress import Tell
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
TORN, COUNT = SIZE + 3, SIZE + 4
"""Columns of a leaf after field and place: see `Leaves`, and how many clusters are near."""
DEPTH = 12
"""More than blocks are ever halved."""
SPLIT = 5e-3
"""What a cluster may leave out in a block, or else it is halved."""


def find_doubt(
    caps: Caps, resolution: int, winding_threshold: float, tell: Tell = lambda done: None
) -> Doubt:
    """Bound the caps' winding number over the cells of the lattice.

    Parameters
    ----------
    caps : Caps
    resolution : int
    winding_threshold : float
        tau.
    tell : callable
        See `progress.Tell`.
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
        tell,
    )
    rows = count = 0
    for blocks, fine, leaves, _ in found:
        coarse[tuple(blocks.T)] += rows
        fine[fine >= 0] += count
        rows, count = rows + len(fine), count + len(leaves)
    _, fine, leaves, near = (np.concatenate(parts) for parts in zip(*found, strict=True))
    start = np.concatenate([[0], np.cumsum(leaves[:, COUNT], dtype=np.int64)])
    field = np.ascontiguousarray(leaves[:, :SIZE])
    place, is_torn = np.ascontiguousarray(leaves[:, SIZE:TORN]), leaves[:, TORN] > 0
    return Doubt(coarse, fine, Leaves(place, field, is_torn, start, near), clusters)


@compiled
def _decide(clusters, resolution, tau, corner, top, coarse):
    """Put the codes of the blocks in a cube of `top` cells into `coarse`.

    Returns which blocks are not decided as a whole, shape (u, 3); the codes of their cells; a
    row for each leaf that these name: field, place, TORN, COUNT; and the clusters near them.
    """
    blocks, fine = np.empty((16, 3), np.int32), np.empty((16, BLOCK, BLOCK, BLOCK), np.int32)
    leaves, nearby = np.empty((64, COUNT + 1)), np.empty(1024, np.int32)
    rows = kept = listed = 0
    waiting, count = np.empty((64, 5), np.int64), 1  # blocks: corner, size and depth
    put(corner, waiting[0])
    waiting[0, 3], waiting[0, 4] = top, 1
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
        reach = half * np.sqrt(3)
        middle[depth, 0], middle[depth, 1], middle[depth, 2] = q
        _take_over(far[depth - 1], middle[depth - 1], far[depth], q)
        among = near[depth - 1, : nears[depth - 1]]
        nears[depth] = set_apart(clusters, among, far[depth], near[depth], q, reach)
        close = near[depth, : nears[depth]]
        put(far[depth], field)
        tears = view(clusters, close, field, q, reach, SPLIT)
        code = _code(field, tears, half, size, tau)
        a, b, c, wide = x // BLOCK, y // BLOCK, z // BLOCK, size // BLOCK
        if size >= BLOCK and code < 0:
            coarse[a : a + wide, b : b + wide, c : c + wide] = code
            continue
        if size == BLOCK:
            if rows == len(fine):
                blocks, fine = grown(blocks), grown(fine)
            blocks[rows, 0], blocks[rows, 1], blocks[rows, 2] = a, b, c
            coarse[a, b, c] = rows
            rows += 1
        if size > BLOCK or (code == UNSURE and size > LEAST):
            count = _halve(waiting, count)
            continue
        if code >= 0:
            if kept == len(leaves):
                leaves = grown(leaves)
            asked = code == UNSURE
            _keep(leaves[kept], far[depth] if asked else field, q, tears and not asked)
            if asked:
                leaves[kept, COUNT] = len(close)
                while listed + len(close) > len(nearby):
                    nearby = grown(nearby)
                put(close, nearby[listed:])
                listed += len(close)
            code = kept
            kept += 1
        i, j, k = x % BLOCK, y % BLOCK, z % BLOCK
        fine[rows - 1, i : i + size, j : j + size, k : k + size] = code
    return blocks[:rows].copy(), fine[:rows].copy(), leaves[:kept].copy(), nearby[:listed].copy()


@compiled(inline="always")
def _take_over(field, place, mine, q):
    """Move the field of a block around `place` to the middle of one of its halves."""
    way = between(place, q)
    put(field, mine)
    move(mine, way[0], way[1], way[2])


@compiled
def _halve(waiting, count):
    """Put a block's eight halves in its place; return how many blocks wait."""
    x, y, z, size, depth = waiting[count]
    size //= 2
    for corner in range(8):
        half = waiting[count + corner]
        half[0] = x + size * (corner >> 2)
        half[1] = y + size * (corner >> 1 & 1)
        half[2] = z + size * (corner & 1)
        half[3], half[4] = size, depth + 1
    return count + 8


@compiled(inline="always")
def _keep(leaf, field, q, is_torn):
    put(field, leaf)
    leaf[SIZE], leaf[SIZE + 1], leaf[SIZE + 2] = q
    leaf[TORN], leaf[COUNT] = is_torn, 0


@compiled
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
