"""How long work reports itself, and how it is stopped."""

import threading
from collections.abc import Callable

Progress = Callable[[str, float], None]
"""Called with a stage's name and the fraction of it done, from 0 to 1.

Every stage calls it often enough for a bar to move. To cancel, raise
`cutcell.Cancelled` inside it: the stage stops there and the exception goes through.
"""


Tell = Callable[[float], None]
"""Called with the fraction that is done of a part of a stage, from 0 to 1; see `share_of`."""


def silent(stage: str, fraction: float) -> None:
    """Report nothing."""


def share_of(tell: Tell, low: float, high: float) -> Tell:
    """Report a part of the work that goes from one fraction of the whole to another."""
    return lambda done: tell(low + (high - low) * done)


class Shares:
    """Progress of a stage that threads share, reported as a whole by one of them at a time.

    Parameters
    ----------
    progress : callable
    stage : str
    count : int
        Into how many equal shares the work is divided.
    """

    def __init__(self, progress: Progress, stage: str, count: int) -> None:
        self._progress = progress
        self._stage = stage
        self._done = [0.0] * count
        self._lock = threading.Lock()

    def tell(self, share: int, done: float) -> None:
        """Report how much of a share is done."""
        with self._lock:
            self._done[share] = done
            self._progress(self._stage, sum(self._done) / len(self._done))
