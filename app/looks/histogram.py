"""Histogram of the chosen joint's weight over the selection."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell_viewers.weights_scene import columns_of

from ..document.selection import selected
from ..document.state import State

BARS = 20
"""Bars from 0 to 1; vertices without weight are in none."""


def bar_of(weight: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the bar of each weight; -1 without weight."""
    bar = np.minimum(np.ceil(weight * BARS - 1e-9).astype(np.intp) - 1, BARS - 1)
    return np.where(weight > 0, np.maximum(bar, 0), -1)


def counts(state: State) -> NDArray[np.intp]:
    """Return how many selected vertices each bar has; of all vertices, without a selection."""
    chosen = selected(state)
    weight = columns_of(state.rows, [state.joint])[:, 0]
    bar = bar_of(weight if chosen is None else weight[chosen])
    return np.bincount(bar[bar >= 0], minlength=BARS)


def in_bars(state: State) -> NDArray[np.bool_] | None:
    """Return which vertices the chosen bars hold, shape (n,); None if no bar is chosen."""
    if not state.histogram or state.bars is None or state.rows is None:
        return None
    chosen, (first, last) = selected(state), state.bars

    def find() -> NDArray[np.bool_]:
        bar = bar_of(columns_of(state.rows, [state.joint])[:, 0])
        within = (bar >= first) & (bar <= last)
        return within if chosen is None else within & chosen

    inputs = state.rows, chosen, state.joint, first, last
    vertices: NDArray[np.bool_] = state.memo("vertices of bars", inputs, find)
    return vertices


def histogram_rows(state: State) -> dict[str, Any]:
    """Return labels and counts of the bars, and which of them are chosen."""
    if not state.histogram or state.rows is None or state.bare:
        return {"bars": [], "chosen": []}
    ends = np.arange(BARS + 1) / BARS
    bars = [
        (f"{low:g} to {high:g}", int(count))
        for low, high, count in zip(ends[:-1], ends[1:], counts(state), strict=True)
    ]
    return {"bars": bars, "chosen": list(state.bars or ())}
