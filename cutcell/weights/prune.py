"""Pruning: few influences a vertex, as files and graphics cards want them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.vectors import TIE
from ..runtime.compiled import compiled
from ..runtime.progress import Tell
from ..runtime.threads import in_threads, parts, threads

A_PART = 2_000_000
"""Weights of one part of the work, which takes some hundredths of a second."""


def prune(
    weights: NDArray[np.float64],
    max_influences: int | None,
    threshold: float,
    priority: NDArray[np.intp],
    report: Tell = lambda done: None,
    scaled: bool = True,
) -> NDArray[np.float64]:
    """Keep the largest weights of each vertex and make them sum to one again, if `scaled`.

    Of equal weights those of the first joints by priority are kept: two bones that meet in a joint
    weigh the same wherever that joint is the nearest point of both.

    Shapes: weights (n, j), priority (j,); returns (n, j).
    """
    most = weights.shape[1] if max_influences is None else max_influences
    pruned = np.zeros(weights.shape)
    in_threads(
        lambda part: _prune(weights[part], most, threshold, priority, scaled, pruned[part]),
        parts(len(weights), threads() + weights.size // A_PART),
        report,
    )
    return pruned


@compiled
def _prune(weights, most, threshold, priority, scaled, pruned):
    joints = np.empty(len(priority), np.intp)
    for v in range(len(weights)):
        _keep_largest(weights[v], most, threshold, priority, scaled, joints, pruned[v])


@compiled
def _keep_largest(row, most, threshold, priority, scaled, joints, pruned):
    """Prune one vertex, see `prune`. `pruned` is zero; `joints` is scratch space for all joints."""
    count = 0
    for joint in priority:
        weight = row[joint]
        if weight == 0:
            continue
        if count < most:
            count += 1
        elif weight <= row[joints[count - 1]] + TIE:
            continue
        rank = count - 1
        while rank > 0 and row[joints[rank - 1]] + TIE < weight:
            joints[rank] = joints[rank - 1]
            rank -= 1
        joints[rank] = joint
    # Now the largest come first.
    total = 0.0
    for k in range(count):
        total += row[joints[k]]
    least = threshold * total
    while count > 1 and row[joints[count - 1]] < least:
        count -= 1
        total -= row[joints[count]]
    for k in range(count):
        pruned[joints[k]] = row[joints[k]] / total if scaled else row[joints[k]]
