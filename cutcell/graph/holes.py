"""Where holes of a mesh leave inside and outside in doubt, block by block of the lattice.

With its holes capped a mesh is closed, and its winding number is the signed count chi' of
crossings ahead, a whole number. The open mesh's own number is less by what the caps cover
of the view: w = chi' - w_caps, so that

    w >= tau   <=>   chi' >= need,   need = ceil(tau + w_caps).

w_caps is small and smooth away from the holes. This file bounds it over whole blocks of
cells, see `view.py` for the proof: in most blocks `need` is one number. Around the
surfaces where it changes, w_caps is as good as linear over blocks of a few cells, and what
is on which side of a plane is quickly told. Only next to the rims of holes, and nearly on
these surfaces, the winding number itself must be asked.

Blocks are halved from the whole cube down to single cells. Each hands down to its parts what
it knows: the field of the caps that are far from all of it, and a list of the others. So a
midpoint in doubt has but a short list to sum.

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

from ..threads import in_threads
from .caps import Caps
from .clusters import ROOT, Clusters, cluster
from .rays import grown
from .view import NOTHING, Field, gather, moved, view

BLOCK = 8
"""Cells along the side of the blocks that are decided as a whole, or else cell by cell."""
WORTH = 20
"""Midpoints in doubt for which it is worth the time to halve a block."""
CLOSEST = 0.0, 0.8, 0.7, 0.0, 0.5
"""How near caps may be to a block of so many cells to count as far, see `view.gather`."""
MANY = 32
"""Caps near to a block above which to halve it is quicker than to look at each of them."""
SPLIT = 0.1, 4e-3
"""What one of the others may leave out in a block: less if the first bound is not enough."""
TOLERANCES = 3e-2, 1e-4, 1e-6
"""What a cluster may leave out at a midpoint: less and less until the bound is enough."""
UNSURE = 1 << 30
"""No need: the number must be asked."""
NEED = -(1 << 20)
"""Codes of cells are NEED + need, which is negative, or else the row of a leaf."""
ROUNDING = 1e-9


class Leaves(NamedTuple):
    """Blocks of cells that are not halved, though inside and outside are in doubt there.

    Parameters
    ----------
    place : array, shape (n, 3)
        The middle of each block.
    far, plane : arrays, shape (n, 5)
        Fields around it, of all caps that are far from the block, and of all caps. The
        error of the latter is infinite where it is far from linear.
    is_torn : array, shape (n,), bool
        Whether `plane` is only right up to whole numbers.
    begin, end : arrays, shape (n,), int64
        The caps that are not far are near[begin] to near[end - 1].
    near : array, int64
        Clusters.
    """

    place: NDArray[np.float64]
    far: NDArray[np.float64]
    plane: NDArray[np.float64]
    is_torn: NDArray[np.bool_]
    begin: NDArray[np.int64]
    end: NDArray[np.int64]
    near: NDArray[np.int64]


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
    rows = leaves = near = 0
    for blocks, fine, part in found:
        coarse[tuple(blocks.T)] += rows
        fine[fine >= 0] += leaves
        part.begin[:] += near
        part.end[:] += near
        rows, leaves, near = rows + len(fine), leaves + len(part.place), near + len(part.near)
    columns = zip(*(part for *_, part in found), strict=True)
    joined = Leaves(*(np.concatenate(column) for column in columns))
    return Doubt(coarse, np.concatenate([fine for _, fine, _ in found]), joined, clusters)


@njit(cache=True, nogil=True)
def _decide(clusters, resolution, tau, corner, top, coarse):
    """Put the codes of the blocks in a cube of `top` cells into `coarse`.

    Returns which blocks are not decided as a whole, shape (u, 3); the codes of their cells;
    and the leaves that these name.
    """
    blocks, fine = np.empty((16, 3), np.int64), np.empty((16, BLOCK, BLOCK, BLOCK), np.int32)
    place, far, plane = np.empty((64, 3)), np.empty((64, 5)), np.empty((64, 5))
    is_torn, near_range = np.empty(64, np.bool_), np.zeros((64, 2), np.int64)
    near = np.empty(1024, np.int64)
    rows = leaves = 0
    # Blocks that wait: corner, size, the list that they look at; and the field around a place.
    waiting, known = np.empty((64, 6), np.int64), np.zeros((64, 8))
    listed = np.empty(1024, np.int64)
    listed[0] = ROOT
    waiting[0, :3], waiting[0, 3], waiting[0, 4], waiting[0, 5], count = corner, top, 0, 1, 1
    while count:
        count -= 1
        x, y, z, size, begin, end = waiting[count]
        if max(x, y, z) >= resolution:
            continue
        half = size / (2 * resolution)
        q = x / resolution + half, y / resolution + half, z / resolution + half
        field = moved(_field(known[count, 3:]), known[count, :3], q)
        # What lies beyond `end` in the list belonged to blocks that are done.
        reach = half * np.sqrt(3)
        closest = CLOSEST[min(size, 4)]
        listed, last, field = gather(clusters, listed, begin, end, q, reach, closest, field)
        for tolerance in SPLIT:
            whole, tears = view(clusters, listed[end:last], field, q, reach, tolerance, 0.5)
            code = _code(whole, tears, half, size, tau)
            if code < 0 or whole.error == np.inf or size == 1 or last - end > MANY:
                break
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
        if size > BLOCK or (code == UNSURE and size > 1):
            for corner8 in range(8):
                child = waiting[count]
                child[0] = x + size // 2 * (corner8 >> 2)
                child[1] = y + size // 2 * (corner8 >> 1 & 1)
                child[2] = z + size // 2 * (corner8 & 1)
                child[3], child[4], child[5] = size // 2, end, last
                known[count, 0], known[count, 1], known[count, 2] = q
                _put(known[count, 3:], field)
                count += 1
            continue
        if code >= 0:
            if leaves == len(place):
                place, far, plane = grown(place), grown(far), grown(plane)
                is_torn, near_range = grown(is_torn), grown(near_range)
            place[leaves, 0], place[leaves, 1], place[leaves, 2] = q
            _put(far[leaves], field)
            _put(plane[leaves], whole)
            if code == UNSURE:
                plane[leaves, 4] = np.inf
            is_torn[leaves] = tears
            first = near_range[leaves - 1, 1] if leaves else 0
            while first + last - end > len(near):
                near = grown(near)
            near[first : first + last - end] = listed[end:last]
            near_range[leaves, 0], near_range[leaves, 1] = first, first + last - end
            code = leaves
            leaves += 1
        i, j, k = x % BLOCK, y % BLOCK, z % BLOCK
        fine[rows - 1, i : i + size, j : j + size, k : k + size] = code
    return (
        blocks[:rows].copy(),
        fine[:rows].copy(),
        Leaves(
            place[:leaves].copy(),
            far[:leaves].copy(),
            plane[:leaves].copy(),
            is_torn[:leaves].copy(),
            near_range[:leaves, 0].copy(),
            near_range[:leaves, 1].copy(),
            near[: near_range[leaves - 1, 1] if leaves else 0].copy(),
        ),
    )


@njit(cache=True, inline="always")
def _field(row):
    return Field(row[0], row[1], row[2], row[3], row[4])


@njit(cache=True, inline="always")
def _put(row, field):
    row[0], row[1], row[2], row[3], row[4] = field


@njit(cache=True)
def _code(field, is_torn, half, size, tau):
    """Return NEED + need of a block; or 0 if its field is to be kept; or UNSURE."""
    error = field.error + ROUNDING
    if error >= 0.5:
        return UNSURE
    slope = half * (abs(field.x) + abs(field.y) + abs(field.z))
    low = np.ceil(tau + field.value - slope - error)
    if low == np.ceil(tau + field.value + slope + error):
        if not is_torn:
            return NEED + np.int64(low)
    elif 3 * size**3 * min(error, slope) > WORTH * slope and size > 1:
        return UNSURE  # the plane that parts the block is thick: many midpoints lie in it
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
def on_plane(leaves, leaf, p):
    """Return what all caps cover at a point in a leaf, and how far that may be off."""
    field = moved(_field(leaves.plane[leaf]), leaves.place[leaf], p)
    return field.value, field.error + ROUNDING


@njit(cache=True)
def summed(doubt, leaf, p, tolerance):
    """Return the same by summing what is near."""
    leaves, clusters = doubt.leaves, doubt.clusters
    far = moved(_field(leaves.far[leaf]), leaves.place[leaf], p)
    near = leaves.near[leaves.begin[leaf] : leaves.end[leaf]]
    field, _ = view(clusters, near, far, p, 0.0, tolerance, 0.5)
    return field.value, field.error + ROUNDING


@njit(cache=True)
def need_at(doubt, leaf, p, tau):
    """Return the need at a point in a leaf, or UNSURE if only an exact sum can tell."""
    for tolerance in TOLERANCES:
        value, error = summed(doubt, leaf, p, tolerance)
        if error == np.inf:
            return UNSURE
        need = need_between(tau + value, error)
        if need < UNSURE:
            return need
        if error < 2 * doubt.leaves.far[leaf, 4]:
            break  # most of it is what the far caps leave out
    everything = np.array([ROOT])
    for tolerance in (1e-4, 1e-6):
        field, _ = view(doubt.clusters, everything, NOTHING, p, 0.0, tolerance, 0.5)
        if field.error == np.inf:
            break
        need = need_between(tau + field.value, field.error + ROUNDING)
        if need < UNSURE:
            return need
    return UNSURE


@njit(cache=True, inline="always")
def need_between(value, error):
    """Return the next whole number above a value that may be off, or UNSURE."""
    low = np.ceil(value - error)
    return np.int64(low) if low == np.ceil(value + error) else UNSURE
