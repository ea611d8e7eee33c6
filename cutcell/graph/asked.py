"""Midpoints that are asked about, block by block.

What is near a block is near all midpoints in it. They look at the clusters of caps together: each
is fetched once, and what it covers is worked out for all of them side by side, in the lanes of
vector instructions. Who is not answered by that looks more closely, by what it is short of; and
at all clusters, not only at those nearby, where what is far from the block leaves out too much.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..compiled import lean
from ..progress import Tell
from ..sorting import sort_into
from ..threads import in_threads
from .clusters import ROOT
from .cover import CLEAR, LANES, ROOM, VALUE, WIDTH, Y, Z, cover
from .doubt import ROUNDING, Doubt
from .field import ERROR, value_at
from .solid_angle import between, length

OUTSIDE, INSIDE, UNTOLD = 0, 1, 2
"""Answers. Where it is untold only an exact sum can tell."""
ABOVE = 3
"""The column of a query after the midpoint's coordinates."""
FIRST, LAST = 1e-2, 1e-9
"""What a cluster may leave out: where it begins, and from where on it is too much work."""
STEP = 1e-2
"""Of what a cluster may leave out, how much the next time at least: few midpoints need far less."""
SAFE = 0.7
"""Of the room that there is, how much is to be left out the next time."""
HOPELESS = 0.8
"""Where the field of a leaf may be off by so much of the room, all clusters are looked at."""
A_WHILE = 2_500_000
"""Midpoints times caps that are looked at in a few hundredths of a second."""


def answer(
    doubt: Doubt,
    leaf: NDArray[np.int32],
    queries: NDArray[np.float64],
    tell: Tell = lambda done: None,
) -> NDArray[np.uint8]:
    """Tell which midpoints are inside.

    Parameters
    ----------
    doubt : Doubt
    leaf : array, shape (q,), int32
        The leaf of `doubt` that each midpoint lies in.
    queries : array, shape (q, 4)
        Each midpoint, and what the caps may cover of the view from it at most if it is inside: the
        crossings ahead, caps counted, less tau.
    tell : callable
        See `progress.Tell`.

    Returns
    -------
    array, shape (q,), uint8
        INSIDE, OUTSIDE or UNTOLD.
    """
    start, order = sort_into(leaf, len(doubt.leaves.place))
    answers = np.empty(len(leaf), np.uint8)
    every = np.array([ROOT], np.int32)

    def some(part: tuple[int, int]) -> None:
        _answer(doubt, queries, leaf, start, order, every, *part, np.empty(ROOM), answers)

    in_threads(some, _portions(doubt, leaf, start, order), tell)
    return answers


def _portions(doubt, leaf, start, order):
    """Cut the midpoints, in their order, so that none takes long; groups stay together."""
    begins = np.flatnonzero((np.arange(len(order)) - start[leaf[order]]) % WIDTH == 0)
    size = max(WIDTH, A_WHILE // len(doubt.clusters.apex))
    wanted = np.arange(0, begins.max(initial=-1) + 1, size)
    bounds = np.unique(begins[np.searchsorted(begins, wanted)])
    return list(pairwise([*bounds.tolist(), len(order)]))


@lean
def _answer(doubt, queries, leaf, start, order, every, first, last, seen, answers):
    """Answer what `order` lists from `first` to before `last`, and put it in another order.

    `every` holds the cluster of all caps; `seen` is room for what `cover` fills in.
    """
    while first < last:
        here = leaf[order[first]]
        end = min(first + WIDTH, start[here + 1])
        _answer_some(doubt, queries, here, order[first:end], every, seen, answers)
        first = end


@lean
def _answer_some(doubt, queries, leaf, unsure, every, seen, answers):
    """Answer at most WIDTH midpoints of a leaf."""
    leaves, clusters = doubt.leaves, doubt.clusters
    middle, field = leaves.place[leaf], leaves.field[leaf]
    near = leaves.near[leaves.start[leaf] : leaves.start[leaf + 1]]
    is_near, tolerance = not leaves.is_torn[leaf], FIRST
    while len(unsure) and tolerance > LAST:
        lanes, centre, reach = _line_up(unsure, queries, seen)
        known = (field[ERROR] if is_near else 0.0) + ROUNDING
        among = near if is_near else every
        off = cover(clusters, among, centre, reach, tolerance, seen, lanes)
        left, margin = 0, np.inf
        for i in range(len(unsure)):
            q, is_clear = unsure[i], seen[CLEAR + i] > 0
            short = queries[q, ABOVE] - seen[VALUE + i]
            if is_near:
                way = between(middle, queries[q])
                short -= value_at(field, way[0], way[1], way[2])
            answers[q] = INSIDE if short > 0 else OUTSIDE
            short = abs(short)
            if not is_clear or short <= known + off:
                answers[q] = UNTOLD
                if is_clear and (is_near or short > known):
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
def _line_up(which, queries, seen):
    """Put midpoints side by side; return how many lanes they fill, and a ball around them."""
    count = len(which)
    x = y = z = 0.0
    for q in which:
        x += queries[q, 0] / count
        y += queries[q, 1] / count
        z += queries[q, 2] / count
    reach = 0.0
    for q in which:
        reach = max(reach, length(between((x, y, z), queries[q])))
    lanes = -(-count // LANES) * LANES
    for i in range(lanes):
        q = which[min(i, count - 1)]
        seen[i], seen[Y + i], seen[Z + i] = queries[q, 0], queries[q, 1], queries[q, 2]
    return lanes, (x, y, z), reach
