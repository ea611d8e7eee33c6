"""Point queries: which midpoints of ambiguous cells are inside, block by block.

All clusters near a block are near all its midpoints. So these evaluate the clusters together, by
vector instructions, with the local expansion of the block for what is far. Queries that the error
bounds leave undecided are evaluated again with a smaller tolerance, as far as each is from the
threshold; and with all clusters, where the error of the local expansion is too large.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....geometry.vectors import between, length
from ....runtime.compiled import no_refcount
from .clusters import ROOT, Clusters
from .expansion import ERROR, ROUNDING_ERROR, LocalExpansions, evaluate
from .solid_angles import (
    CLEAR,
    POINTS_TOGETHER,
    SIMD_WIDTH,
    VALUE,
    WORKSPACE,
    Y,
    Z,
    caps_winding_numbers,
)

FIRST_TOLERANCE, LAST_TOLERANCE = 1e-2, 1e-9
"""Tolerance of a cluster's error: at first, and below which the exact formula is faster."""
MIN_REDUCTION = 1e-2
"""The smallest factor by which the tolerance is reduced: few queries need a far smaller one."""
SAFETY = 0.7
"""The share of a query's margin that the next error is to be."""
HOPELESS = 0.8
"""Share of the margin: a local expansion with a larger error is not used again."""


def winding_numbers_of_caps(
    expansions: LocalExpansions,
    clusters: Clusters,
    row: NDArray[np.int32],
    points: NDArray[np.float64],
    margin: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Approximate the winding number of the caps, with an error below its distance from `margin`.

    It is NaN where that would take longer than the exact formula.

    Shapes: row (q,), points (q, 3), margin (q,); returns (q,).
    """
    order, values = np.argsort(row, kind="stable"), np.empty(len(row))
    every, workspace = np.array([ROOT], np.int32), np.empty(WORKSPACE)
    _query(expansions, clusters, points, margin, row, order, every, workspace, values)
    return values


@no_refcount
def _query(expansions, clusters, points, margin, row, order, every, workspace, values):
    """Evaluate queries batch by batch; `every` holds the cluster of all caps."""
    first = 0
    while first < len(order):
        end = first + 1
        while (
            end < min(first + POINTS_TOGETHER, len(order)) and row[order[end]] == row[order[first]]
        ):
            end += 1
        queries = points, margin, order[first:end]
        _query_batch(expansions, clusters, row[order[first]], queries, every, workspace, values)
        first = end


@no_refcount
def _query_batch(expansions, clusters, row, queries, every, workspace, values):
    """Evaluate at most BATCH queries of one block; those that are left open are permuted."""
    points, margin, open_queries = queries
    centre, local = expansions.centre[row], expansions.local[row]
    near = expansions.near[expansions.start[row] : expansions.start[row + 1]]
    use_local, tolerance = True, FIRST_TOLERANCE
    while len(open_queries) and tolerance > LAST_TOLERANCE:
        count, middle, reach = _load(open_queries, points, workspace)
        local_error = (local[ERROR] if use_local else 0.0) + ROUNDING_ERROR
        among = near if use_local else every
        error = caps_winding_numbers(clusters, among, middle, reach, tolerance, workspace, count)
        left, least = 0, np.inf
        for i in range(len(open_queries)):
            q, is_clear = open_queries[i], workspace[CLEAR + i] > 0
            values[q] = workspace[VALUE + i]
            if use_local:
                x, y, z = between(centre, points[q])
                values[q] += evaluate(local, x, y, z)
            distance = abs(margin[q] - values[q])
            if not is_clear or distance <= local_error + error:
                values[q] = np.nan
                if is_clear and (use_local or distance > local_error):
                    open_queries[left] = q
                    left += 1
                    least = min(least, distance)
        open_queries = open_queries[:left]
        if use_local and local_error > HOPELESS * least:
            use_local, tolerance = False, min(max((SAFETY * least / 2) ** 2, 1e-4), FIRST_TOLERANCE)
        elif left:  # the error falls with about the square root of the tolerance
            share = SAFETY * (least - local_error) / error
            tolerance *= min(max(share * share, MIN_REDUCTION), 0.5)


@no_refcount
def _load(which, points, workspace):
    """Load midpoints into the workspace, rounded up to full vectors; return a ball around them."""
    count = len(which)
    x = y = z = 0.0
    for q in which:
        x += points[q, 0] / count
        y += points[q, 1] / count
        z += points[q, 2] / count
    reach = 0.0
    for q in which:
        reach = max(reach, length(between((x, y, z), points[q])))
    filled = -(-count // SIMD_WIDTH) * SIMD_WIDTH
    for i in range(filled):
        q = which[min(i, count - 1)]
        workspace[i], workspace[Y + i], workspace[Z + i] = points[q, 0], points[q, 1], points[q, 2]
    return filled, (x, y, z), reach
