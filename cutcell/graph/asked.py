"""Midpoints that are asked about, block by block.

What is near a block is near all midpoints in it. They look at the clusters of caps together: each
is fetched once, and what it covers is worked out for all of them side by side, in the lanes of
vector instructions. Who is not answered by that looks more closely, by what it is short of; and
at all clusters, not only at those nearby, where what is far from the block leaves out too much.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import lean
from ..sorting import sort_into
from ..threads import in_threads, parts
from .clusters import ROOT
from .cover import CLEAR, LANES, ROOM, VALUE, WIDTH, Y, Z, cover
from .doubt import ROUNDING, UNSURE, Doubt, need_between
from .field import ERROR, value_at
from .solid_angle import between, length

FIRST, LAST = 1e-2, 1e-9
"""What a cluster may leave out: where it begins, and from where on it is too much work."""
STEP = 1e-2
"""Of what a cluster may leave out, how much the next time at least: few midpoints need far less."""
SAFE = 0.7
"""Of the room that there is, how much is to be left out the next time."""
HOPELESS = 0.8
"""Where the field of a leaf may be off by so much of the room, all clusters are looked at."""


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
    start, order = sort_into(leaf, len(doubt.leaves.place))
    needs = np.empty(len(leaf), np.int32)
    asked = points, start, order, np.array([ROOT], np.int32)

    def some(part: slice) -> None:
        seen = np.empty(ROOM)
        _answer(doubt, winding_threshold, *asked, part.start, part.stop, seen, needs)

    in_threads(some, parts(len(start) - 1))
    return needs


@lean
def _answer(doubt, tau, points, start, order, every, first, last, seen, needs):
    """Answer the midpoints of the leaves from `first` to before `last`; `order` is changed.

    `every` holds the cluster of all caps; `seen` is room for what `cover` fills in.
    """
    for leaf in range(first, last):
        for begin in range(start[leaf], start[leaf + 1], WIDTH):
            unsure = order[begin : min(begin + WIDTH, start[leaf + 1])]
            _answer_some(doubt, tau, points, leaf, unsure, every, seen, needs)


@lean
def _answer_some(doubt, tau, points, leaf, unsure, every, seen, needs):
    """Answer at most WIDTH midpoints of a leaf."""
    leaves, clusters = doubt.leaves, doubt.clusters
    middle, field = leaves.place[leaf], leaves.field[leaf]
    near = leaves.near[leaves.start[leaf] : leaves.start[leaf + 1]]
    is_near, tolerance = not leaves.is_torn[leaf], FIRST
    while len(unsure) and tolerance > LAST:
        lanes, centre, reach = _line_up(unsure, points, seen)
        known = (field[ERROR] if is_near else 0.0) + ROUNDING
        among = near if is_near else every
        off = cover(clusters, among, centre, reach, tolerance, seen, lanes)
        left, margin = 0, 0.5
        for i in range(len(unsure)):
            q, is_clear = unsure[i], seen[CLEAR + i] > 0
            value = tau + seen[VALUE + i]
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
        seen[i], seen[Y + i], seen[Z + i] = points[q, 0], points[q, 1], points[q, 2]
    return lanes, (x, y, z), reach
