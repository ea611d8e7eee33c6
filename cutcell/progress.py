"""How long work reports itself, and how it is stopped."""

import threading
from collections.abc import Callable

Progress = Callable[[str, float], None]
"""Called with a stage's name and the fraction of it done, from 0 to 1.

Every stage calls it often enough for a bar to move. To cancel, raise
`cutcell.Cancelled` inside it: the stage stops there and the exception goes through.
"""


def silent(stage: str, fraction: float) -> None:
    """Report nothing."""


class Shares:
    """Progress of a stage that threads share: told as a whole, by one of them at a time.

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
