"""Where holes of a mesh leave inside and outside in doubt, block by block of the lattice.

With its holes capped a mesh is closed, and its winding number is the signed count chi' of
crossings ahead, a whole number. The open mesh's own number is less by what the caps cover
of the view: w = chi' - w_caps, so that

    w >= tau   <=>   chi' >= need,   need = ceil(tau + w_caps).

w_caps is small and smooth away from the holes. This file bounds it over whole blocks of
cells: where `need` is one number for a block, no winding number is evaluated in it.

The bound. Off the caps, w_caps is harmonic and its gradient is the Biot-Savart integral
over the holes' rims, grad w_caps = 1/(4 pi) sum c int (r x dl) / |r|^3, so over a block that
no cap enters it differs from its value at the block's centre by at most

    radius * sum |c| length / (4 pi distance^2),

with the rim edges' distances to the nearest point of the block. A fan farther away than a
few of its own sizes is not evaluated at all: it covers at most area / (4 pi distance^2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..threads import in_threads, parts
from .caps import Caps

BLOCK = 8
"""Cells along a block's side; undecided blocks are halved down to single cells."""
UNSURE = 127
FAR = 0.1
"""What all fans that are bounded rather than evaluated may cover together."""
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Needs:
    """How many crossings ahead, caps counted, it takes to be inside.

    Parameters
    ----------
    coarse : array, shape (b, b, b), int8
        For each block of BLOCK^3 cells; UNSURE where its cells differ.
    row : array, shape (b, b, b), int32
        Where `fine` holds an unsure block.
    fine : array, shape (u, BLOCK, BLOCK, BLOCK), int8
        For each cell; UNSURE where the winding number itself must be asked.
    """

    coarse: NDArray[np.int8]
    row: NDArray[np.int32]
    fine: NDArray[np.int8]


def find_needs(caps: Caps, resolution: int, winding_threshold: float) -> Needs:
    """Bound the caps' winding number over the cells of the lattice.

    Parameters
    ----------
    caps : Caps
    resolution : int
    winding_threshold : float
        tau.
    """
    blocks = -(-resolution // BLOCK)
    coarse = np.full((blocks,) * 3, int(np.ceil(winding_threshold)), np.int8)
    row = np.full((blocks,) * 3, -1, np.int32)
    fans = (
        caps.vertices,
        caps.faces,
        caps.count.astype(np.float64),
        caps.start,
        caps.centre,
        caps.radius,
        caps.area,
        winding_threshold,
    )
    if len(caps.faces):
        cells = coarse.reshape(-1)
        in_threads(
            lambda part: _decide_blocks(fans, 1 / resolution, blocks, part.start, part.stop, cells),
            parts(len(cells)),
        )
    unsure = np.argwhere(coarse == UNSURE)
    row[tuple(unsure.T)] = np.arange(len(unsure))
    fine = np.full((len(unsure), BLOCK, BLOCK, BLOCK), UNSURE, np.int8)
    if len(unsure):
        in_threads(
            lambda part: _refine_blocks(fans, 1 / resolution, unsure[part], fine[part]),
            parts(len(unsure), len(unsure) // 4 + 1),
        )
    return Needs(coarse, row, fine)


@njit(cache=True, nogil=True)
def _decide_blocks(fans, cell, blocks, first, last, coarse):
    half = BLOCK * cell / 2
    for b in range(first, last):
        x, y, z = b // blocks**2, b // blocks % blocks, b % blocks
        q = np.array([(2 * x + 1) * half, (2 * y + 1) * half, (2 * z + 1) * half])
        coarse[b] = _need(fans, q, half * np.sqrt(3))


@njit(cache=True, nogil=True)
def _refine_blocks(fans, cell, unsure, fine):
    for u in range(len(unsure)):
        corner = unsure[u] * BLOCK * cell
        for size in (4, 2, 1):
            half = size * cell / 2
            for x in range(0, BLOCK, size):
                for y in range(0, BLOCK, size):
                    for z in range(0, BLOCK, size):
                        if fine[u, x, y, z] == UNSURE:
                            q = corner + np.array([x, y, z]) * cell + half
                            need = _need(fans, q, half * np.sqrt(3))
                            fine[u, x : x + size, y : y + size, z : z + size] = need


@njit(cache=True)
def _need(fans, q, reach):
    """Return ceil(tau + w_caps) if it is one number within `reach` of q, else UNSURE."""
    vertices, faces, count, start, centre, radius, area, tau = fans
    bound = np.empty(len(radius))
    for k in range(len(radius)):
        away = _distance(centre[k], q) - radius[k] - reach
        bound[k] = area[k] / (4 * np.pi * away * away) if away > 0 else np.inf
    # The fans that matter least are only bounded, as many as together hardly matter.
    order = np.argsort(bound)
    error = ROUNDING
    bounded = 0
    while bounded < len(order) and error + bound[order[bounded]] < FAR:
        error += bound[order[bounded]]
        bounded += 1
    for k in order[bounded:]:
        for f in range(start[k], start[k + 1]):
            a, b, apex = vertices[faces[f, 1]], vertices[faces[f, 0]], vertices[faces[f, 2]]
            gap = _distance_to_edge(q, a, b) - reach
            if gap <= 0 or _cap_within(q, a, b, apex, reach):
                return UNSURE
            error += reach * abs(count[f]) * _distance(a, b) / (4 * np.pi * gap * gap)
            if error > 0.5:
                return UNSURE
    covered = 0.0
    for k in order[bounded:]:
        for f in range(start[k], start[k + 1]):
            corners = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
            covered += count[f] * _covered_by(q, *corners)
    low = np.ceil(tau + covered - error)
    return np.int64(low) if low == np.ceil(tau + covered + error) else UNSURE


@njit(cache=True, inline="always")
def _distance(a, b):
    x, y, z = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return np.sqrt(x * x + y * y + z * z)


@njit(cache=True, inline="always")
def _distance_to_edge(q, a, b):
    ex, ey, ez = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    px, py, pz = q[0] - a[0], q[1] - a[1], q[2] - a[2]
    t = (px * ex + py * ey + pz * ez) / (ex * ex + ey * ey + ez * ez)
    t = min(max(t, 0.0), 1.0)
    x, y, z = px - t * ex, py - t * ey, pz - t * ez
    return np.sqrt(x * x + y * y + z * z)


@njit(cache=True)
def _cap_within(q, a, b, apex, reach):
    """Tell whether a triangle may come within reach of q: its plane and its sphere do."""
    ex, ey, ez = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    fx, fy, fz = apex[0] - a[0], apex[1] - a[1], apex[2] - a[2]
    nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    px, py, pz = q[0] - a[0], q[1] - a[1], q[2] - a[2]
    height = abs(nx * px + ny * py + nz * pz)
    if height > reach * np.sqrt(nx * nx + ny * ny + nz * nz):
        return False
    middle = (a + b + apex) / 3
    size = max(_distance(middle, a), _distance(middle, b), _distance(middle, apex))
    return _distance(middle, q) <= size + reach


@njit(cache=True)
def _covered_by(q, a, b, c):
    """Return the solid angle of a triangle over 4 pi (van Oosterom & Strackee 1983)."""
    ax, ay, az = a[0] - q[0], a[1] - q[1], a[2] - q[2]
    bx, by, bz = b[0] - q[0], b[1] - q[1], b[2] - q[2]
    cx, cy, cz = c[0] - q[0], c[1] - q[1], c[2] - q[2]
    la = np.sqrt(ax * ax + ay * ay + az * az)
    lb = np.sqrt(bx * bx + by * by + bz * bz)
    lc = np.sqrt(cx * cx + cy * cy + cz * cz)
    triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    rest = (
        la * lb * lc
        + (ax * bx + ay * by + az * bz) * lc
        + (bx * cx + by * cy + bz * cz) * la
        + (cx * ax + cy * ay + cz * az) * lb
    )
    return np.arctan2(triple, rest) / (2 * np.pi)
