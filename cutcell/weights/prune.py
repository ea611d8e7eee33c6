"""Pruning: few influences a vertex, as files and graphics cards want them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..geometry.vectors import TIE
from ..runtime.compiled import compiled
from ..runtime.progress import Tell
from ..runtime.threads import in_threads, parts


def prune(
    weights: csr_array,
    max_influences: int | None,
    threshold: float,
    priority: NDArray[np.intp],
    report: Tell = lambda done: None,
    scaled: bool = True,
) -> csr_array:
    """Keep the largest weights of each vertex and make them sum to one again, if `scaled`.

    Of equal weights those of the first joints by priority are kept: two bones that meet in a joint
    weigh the same wherever that joint is the nearest point of both.

    Shapes: weights (n, j), priority (j,); returns (n, j).
    """
    most = weights.shape[1] if max_influences is None else max_influences
    rows, pruned = (weights.indptr, weights.indices, weights.data), np.zeros(weights.nnz)
    options = most, threshold, priority, scaled

    def work(part: slice) -> None:
        _prune(part.start, part.stop, *rows, *options, pruned)

    in_threads(work, parts(weights.shape[0]), report)
    nonzero = np.flatnonzero(pruned)
    start = np.searchsorted(nonzero, weights.indptr)
    return csr_array((pruned[nonzero], weights.indices[nonzero], start), weights.shape)


@compiled
def _prune(first, last, begin, joint, weight, most, threshold, priority, scaled, pruned):
    """Prune some vertices, see `prune`. `pruned` is zero."""
    entry_of, strongest = np.full(len(priority), -1), np.empty(len(priority), np.intp)
    for v in range(first, last):
        for e in range(begin[v], begin[v + 1]):
            entry_of[joint[e]] = e
        count = 0
        for j in priority:
            e, entry_of[j] = entry_of[j], -1
            if e < 0 or weight[e] == 0:
                continue
            if count < most:
                count += 1
            elif weight[e] <= weight[strongest[count - 1]] + TIE:
                continue
            rank = count - 1
            while rank > 0 and weight[strongest[rank - 1]] + TIE < weight[e]:
                strongest[rank] = strongest[rank - 1]
                rank -= 1
            strongest[rank] = e
        # Now the largest come first.
        total = 0.0
        for k in range(count):
            total += weight[strongest[k]]
        least = threshold * total
        while count > 1 and weight[strongest[count - 1]] < least:
            count -= 1
            total -= weight[strongest[count]]
        for k in range(count):
            pruned[strongest[k]] = weight[strongest[k]] / total if scaled else weight[strongest[k]]
