"""Point queries: which midpoints of ambiguous cells are inside, block by block.

All clusters near a block are near all its midpoints. So these evaluate the clusters together, by
vector instructions, with the local expansion of the block for what is far. Queries that the error
bounds leave undecided are evaluated again with a smaller tolerance, as far as each is from the
threshold; and with all clusters, where the error of the local expansion is too large.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....geometry.counting_sort import counting_sort
from ....geometry.vectors import between, length
from ....runtime.compiled import no_refcount
from ....runtime.progress import Tell
from ....runtime.threads import in_threads
from .clusters import ROOT, Clusters
from .expansion import ERROR, ROUNDING, LocalExpansions, evaluate
from .solid_angles import (
    BATCH,
    CLEAR,
    SIMD_WIDTH,
    VALUE,
    WORKSPACE,
    Y,
    Z,
    caps_winding_numbers,
)

OUTSIDE, INSIDE, UNDECIDED = 0, 1, 2
"""Results. Undecided queries are left to the exact formula, `exact.boundary_angle`."""
SLACK = 3
"""The column of a query after the midpoint's coordinates."""
FIRST, LAST = 1e-2, 1e-9
"""Tolerance of a cluster's error: at first, and below which the exact formula is faster."""
STEP = 1e-2
"""The smallest factor by which the tolerance is reduced: few queries need a far smaller one."""
SAFETY = 0.7
"""The share of a query's margin that the next error is to be."""
HOPELESS = 0.8
"""Share of the margin: a local expansion with a larger error is not used again."""
PORTION = 2_500_000
"""Midpoints times caps that are evaluated in a few hundredths of a second."""


def query_points(
    expansions: LocalExpansions,
    clusters: Clusters,
    row: NDArray[np.int32],
    queries: NDArray[np.float64],
    report: Tell = lambda done: None,
) -> NDArray[np.uint8]:
    """Decide whether midpoints are inside.

    Shapes: row (q,), queries (q, 4); returns (q,).
    """
    start, order = counting_sort(row, len(expansions.centre))
    results = np.empty(len(row), np.uint8)
    every = np.array([ROOT], np.int32)

    def evaluate_portion(part: tuple[int, int]) -> None:
        points = np.empty(WORKSPACE)
        _query(expansions, clusters, queries, row, start, order, every, *part, points, results)

    in_threads(evaluate_portion, _portions(clusters, row, start, order), report)
    return results


def _portions(clusters, row, start, order):
    """Divide the sorted queries into portions of limited time that do not divide batches."""
    begins = np.flatnonzero((np.arange(len(order)) - start[row[order]]) % BATCH == 0)
    size = max(BATCH, PORTION // len(clusters.apex))
    targets = np.arange(0, begins.max(initial=-1) + 1, size)
    bounds = np.unique(begins[np.searchsorted(begins, targets)])
    return list(pairwise([*bounds.tolist(), len(order)]))


@no_refcount
def _query(expansions, clusters, queries, row, start, order, every, first, last, points, results):
    """Decide order[first:last], batch by batch; `order` is permuted within batches.

    `every` holds the cluster of all caps; `points` is a workspace.
    """
    while first < last:
        block = row[order[first]]
        end = min(first + BATCH, start[block + 1])
        batch = order[first:end]
        _query_batch(expansions, clusters, queries, block, batch, every, points, results)
        first = end


@no_refcount
def _query_batch(expansions, clusters, queries, row, open_queries, every, points, results):
    """Decide at most BATCH queries of one block."""
    centre, local = expansions.centre[row], expansions.local[row]
    near = expansions.near[expansions.start[row] : expansions.start[row + 1]]
    use_local, tolerance = not expansions.is_crossed[row], FIRST
    while len(open_queries) and tolerance > LAST:
        count, middle, reach = _load(open_queries, queries, points)
        local_error = (local[ERROR] if use_local else 0.0) + ROUNDING
        among = near if use_local else every
        error = caps_winding_numbers(clusters, among, middle, reach, tolerance, points, count)
        left, least = 0, np.inf
        for i in range(len(open_queries)):
            q, is_clear = open_queries[i], points[CLEAR + i] > 0
            margin = queries[q, SLACK] - points[VALUE + i]
            if use_local:
                x, y, z = between(centre, queries[q])
                margin -= evaluate(local, x, y, z)
            results[q] = INSIDE if margin > 0 else OUTSIDE
            margin = abs(margin)
            if not is_clear or margin <= local_error + error:
                results[q] = UNDECIDED
                if is_clear and (use_local or margin > local_error):
                    open_queries[left] = q
                    left += 1
                    least = min(least, margin)
        open_queries = open_queries[:left]
        if use_local and local_error > HOPELESS * least:
            use_local, tolerance = False, min(max((SAFETY * least / 2) ** 2, 1e-4), FIRST)
        elif left:  # the error falls with about the square root of the tolerance
            share = SAFETY * (least - local_error) / error
            tolerance *= min(max(share * share, STEP), 0.5)


@no_refcount
def _load(which, queries, points):
    """Load midpoints into the workspace, rounded up to full vectors; return a ball around them."""
    count = len(which)
    x = y = z = 0.0
    for q in which:
        x += queries[q, 0] / count
        y += queries[q, 1] / count
        z += queries[q, 2] / count
    reach = 0.0
    for q in which:
        reach = max(reach, length(between((x, y, z), queries[q])))
    filled = -(-count // SIMD_WIDTH) * SIMD_WIDTH
    for i in range(filled):
        q = which[min(i, count - 1)]
        points[i], points[Y + i], points[Z + i] = queries[q, 0], queries[q, 1], queries[q, 2]
    return filled, (x, y, z), reach
