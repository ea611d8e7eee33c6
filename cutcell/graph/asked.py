"""Midpoints that are asked about, block by block.

What is near a block is near all midpoints in it. They look at the clusters of caps together: each
is fetched once, and what it covers is worked out for all of them side by side, in the lanes of
vector instructions. Who is not answered by that looks more closely, by what it is short of; and
at all clusters, not only at those nearby, where what is far from the block leaves out too much.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..compiled import lean, side_by_side
from ..threads import in_threads, parts
from .clusters import ROOT, left_out
from .doubt import ROUNDING, UNSURE, Doubt, need_between
from .field import ERROR, value_at
from .moments import cube, linear, square
from .solid_angle import between, length
from .view import CLEAR, after

ROWS = 8
"""Numbers that are kept of each midpoint of a block while it is asked about."""
TINY = 1e-300
FIRST, LAST = 1e-2, 1e-9
"""What a cluster may leave out: where it begins, and from where on it is too much work."""
STEP = 1e-2
"""Of what a cluster may leave out, how much the next time at least: few midpoints need far less."""
SAFE = 0.7
"""Of the room that there is, how much is to be left out the next time."""
HOPELESS = 0.8
"""Where the field of a leaf may be off by so much of the room, all clusters are looked at."""
LANES = 8
"""Midpoints are filled up to a multiple of this: none is left over for a loop of its own."""


def answer(
    doubt: Doubt, winding_threshold: float, leaf: NDArray[np.int32], points: NDArray[np.float64]
) -> NDArray[np.int32]:
    """Tell how many crossings ahead it takes to be inside at each midpoint.

    Parameters
    ----------
    doubt : Doubt
    winding_threshold : float
        tau.
    leaf : array, shape (q,), int32
        The leaf of `doubt` that each midpoint lies in.
    points : array, shape (q, 3)

    Returns
    -------
    array, shape (q,), int32
        UNSURE where only an exact sum can tell.
    """
    start, order = _by_leaf(leaf, len(doubt.leaves.place))
    most = int(np.diff(start).max(initial=0)) + LANES
    needs = np.empty(len(leaf), np.int32)

    def some(part: slice) -> None:
        room = np.empty((ROWS, most))
        _answer(doubt, winding_threshold, points, start, order, part.start, part.stop, room, needs)

    in_threads(some, parts(len(start) - 1))
    return needs


@njit(cache=True, nogil=True)
def _by_leaf(leaf, count):
    """Return where the midpoints of each leaf begin, and their order."""
    start = np.zeros(count + 1, np.int64)
    for q in range(len(leaf)):
        start[leaf[q] + 1] += 1
    start = np.cumsum(start)
    cursor, order = start.copy(), np.empty(len(leaf), np.int64)
    for q in range(len(leaf)):
        order[cursor[leaf[q]]] = q
        cursor[leaf[q]] += 1
    return start, order


@lean
def _answer(doubt, tau, points, start, order, first, last, seen, needs):
    """Answer the midpoints of the leaves from `first` to before `last`; `order` is changed."""
    leaves, clusters = doubt.leaves, doubt.clusters
    for leaf in range(first, last):
        middle, field = leaves.place[leaf], leaves.field[leaf]
        near = leaves.near[leaves.start[leaf] : leaves.start[leaf + 1]]
        unsure = order[start[leaf] : start[leaf + 1]]
        is_near, tolerance = not leaves.is_torn[leaf], FIRST
        while len(unsure) and tolerance > LAST:
            lanes, centre, reach = _line_up(unsure, points, seen)
            if is_near:
                known = field[ERROR] + ROUNDING
                off = _cover(clusters, near, centre, reach, tolerance, seen, lanes)
            else:
                known = ROUNDING
                off = _cover(clusters, (ROOT,), centre, reach, tolerance, seen, lanes)
            left, margin = 0, 0.5
            for i in range(len(unsure)):
                q, is_clear = unsure[i], seen[7, i] > 0
                value = tau + seen[4, i]
                if is_near:
                    way = between(middle, points[q])
                    value += value_at(field, way[0], way[1], way[2])
                needs[q] = need_between(value, known + off if is_clear else np.inf)
                short = abs(value - np.round(value))
                if needs[q] == UNSURE and is_clear and (is_near or short > known):
                    unsure[left] = q
                    left += 1
                    margin = min(margin, short)
            unsure = unsure[:left]
            if is_near and known > HOPELESS * margin:
                is_near, tolerance = False, min(max((SAFE * margin / 2) ** 2, 1e-4), FIRST)
            elif left:  # what is left out falls with about the root of the tolerance
                share = SAFE * (margin - known) / off
                tolerance *= min(max(share * share, STEP), 0.5)


@lean
def _line_up(which, points, seen):
    """Put midpoints side by side; return how many lanes they fill, and a ball around them."""
    count = len(which)
    x = y = z = 0.0
    for q in which:
        x, y, z = x + points[q, 0] / count, y + points[q, 1] / count, z + points[q, 2] / count
    reach = 0.0
    for q in which:
        reach = max(reach, length(between((x, y, z), points[q])))
    lanes = -(-count // LANES) * LANES
    for i in range(lanes):
        q = which[min(i, count - 1)]
        seen[0, i], seen[1, i], seen[2, i] = points[q, 0], points[q, 1], points[q, 2]
    return lanes, (x, y, z), reach


@lean
def _cover(clusters, among, centre, reach, tolerance, seen, lanes):
    """Put what caps cover of the view from the midpoints of a block beside them.

    Parameters
    ----------
    clusters : Clusters
    among : array, int32
        The clusters of these caps.
    centre, reach
        Of a ball that holds all midpoints.
    tolerance : float
        Clusters that may leave out more than this are halved.
    seen : array, shape (ROWS, at least lanes)
        In the rows 0 to 2 the midpoints; gets what is covered (4), and a number above zero where
        that is clear of rounding (7).
    lanes : int
        How many there are.

    Returns
    -------
    error : float
        What that may leave out.
    """
    error, leaves = 0.0, len(clusters.start) - 1
    for i in range(lanes):
        seen[4, i] = seen[6, i] = 0.0
        seen[5, i] = seen[7, i] = 1.0
    for top in among:
        k, end = top, after(top)
        while k != end:
            far = length(between(centre, clusters.sphere[k])) - reach
            off = left_out(clusters.sphere[k], far, 0.0)
            if off <= tolerance:
                _add_afar(clusters.moments[k], clusters.sphere[k], seen, lanes)
                error += off
            elif k < leaves:
                k *= 2
                continue
            else:
                for loop in range(clusters.start[k - leaves], clusters.start[k - leaves + 1]):
                    rim = clusters.rim[clusters.first[loop] : clusters.first[loop + 1]]
                    _turn(rim, clusters.apex[loop], seen, lanes)
            k = after(k)
    for i in range(lanes):
        seen[4, i] += np.arctan2(seen[6, i], seen[5, i]) / (2 * np.pi)
    return error


@side_by_side
def _add_afar(moments, sphere, seen, lanes):
    """Add what a cluster covers, as `moments.covered_afar` tells it."""
    p = (
        moments[0],
        moments[1],
        moments[2],
        moments[3],
        moments[4],
        moments[5],
        moments[6],
        moments[7],
        moments[8],
        moments[9],
        moments[10],
        moments[11],
        moments[12],
        moments[13],
        moments[14],
        moments[15],
        moments[16],
        moments[17],
        moments[18],
    )
    cx, cy, cz = sphere[0], sphere[1], sphere[2]
    for i in range(lanes):
        x, y, z = cx - seen[0, i], cy - seen[1, i], cz - seen[2, i]
        near = 1 / np.sqrt(x * x + y * y + z * z)
        x, y, z = x * near, y * near, z * near
        rest = 7.5 * near * cube(p, x, y, z) - 3 * square(p, x, y, z)
        seen[4, i] += (linear(p, x, y, z) + near * rest) * near * near / (4 * np.pi)


@lean
def _turn(rim, apex, seen, lanes):
    """Turn the midpoints' angles by what one cap covers, as `view._turned` does it for one."""
    # Where the apex is the rim's first vertex, the edges next to it span nothing.
    begin, end = (2, len(rim)) if len(rim) <= 4 else (1, len(rim) + 1)
    for e in range(begin, end):
        _turn_by(apex, rim[e - 1], rim[e if e < len(rim) else 0], seen, lanes)


@side_by_side
def _turn_by(p, q, r, seen, lanes):
    """Turn angles by a triangle p q r."""
    px, py, pz = p[0], p[1], p[2]
    qx, qy, qz = q[0], q[1], q[2]
    rx, ry, rz = r[0], r[1], r[2]
    for i in range(lanes):
        x, y, z = seen[0, i], seen[1, i], seen[2, i]
        cx, cy, cz = px - x, py - y, pz - z
        bx, by, bz = qx - x, qy - y, qz - z
        ax, ay, az = rx - x, ry - y, rz - z
        lc = np.sqrt(cx * cx + cy * cy + cz * cz)
        lb = np.sqrt(bx * bx + by * by + bz * bz)
        la = np.sqrt(ax * ax + ay * ay + az * az)
        triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        rest = la * lb * lc + (ax * bx + ay * by + az * bz) * lc
        rest += (bx * cx + by * cy + bz * cz) * la + (cx * ax + cy * ay + cz * az) * lb
        was, re = seen[6, i], seen[5, i]
        im = re * triple + was * rest
        re = re * rest - was * triple
        # Without a branch, which lanes cannot take each by itself.
        up = (was >= 0) & (triple >= 0) & (im < 0)
        down = (was < 0) & (triple < 0) & (im >= 0)
        seen[4, i] += np.float64(up) - np.float64(down)
        scale = 1 / (abs(re) + abs(im) + TINY)
        seen[5, i], seen[6, i] = re * scale, im * scale
        clear = abs(triple) + max(rest, 0.0) - CLEAR * la * lb * lc
        seen[7, i] = min(seen[7, i], clear)
