"""Times of several ways to the same result, taken in turn."""

from __future__ import annotations

import gc
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from cutcell_lab.benchmarks.tables import seconds


@dataclass(frozen=True)
class Times:
    """Seconds of repeated runs."""

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        """The middle one."""
        return float(np.median(self.seconds))

    def __str__(self) -> str:
        """Median, then the range that the runs covered."""
        low, high = min(self.seconds), max(self.seconds)
        if len(self.seconds) == 1:
            return f"{seconds(self.median)} (once)"
        return f"{seconds(self.median)} ({seconds(low)}..{seconds(high)})"


def in_turn(
    ways: dict[str, Callable[[], object]], repeats: int = 5, patience: float = 30.0
) -> dict[str, Times]:
    """Time several functions one after the other, round after round: A B A B.

    In turn, so that whatever else the machine does meets all alike. The first round is
    not counted if it is short: it compiles and fills caches.

    Parameters
    ----------
    ways : dict of callables without arguments
    repeats : int
        Rounds that count.
    patience : float
        Seconds after which one of them is not run again; its first run then counts.
    """
    times_of: dict[str, list[float]] = {name: [] for name in ways}
    first: dict[str, float] = {}
    for turn in range(repeats + 1):
        for name, call in ways.items():
            if turn and first[name] + sum(times_of[name]) > patience:
                continue
            gc.collect()
            begin = perf_counter()
            call()
            spent = perf_counter() - begin
            if turn:
                times_of[name].append(spent)
            else:
                first[name] = spent
    return {name: Times(tuple(times_of[name] or [first[name]])) for name in ways}
