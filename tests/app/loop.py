"""A page's thread, for tests without a page."""

import queue
import time
from collections.abc import Callable


class Loop:
    """Collects what is scheduled, from any thread, and runs it here."""

    def __init__(self) -> None:
        self._actions: queue.Queue[Callable[[], None]] = queue.Queue()

    def __call__(self, action: Callable[[], None]) -> None:
        self._actions.put(action)

    def run_until(self, condition: Callable[[], bool], seconds: float = 120.0) -> None:
        """Run actions until something holds; fail if it never does."""
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, "it did not come about in time"
            try:
                self._actions.get(timeout=0.02)()
            except queue.Empty:
                continue

    def run_for(self, seconds: float) -> None:
        """Run whatever comes within some time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                self._actions.get(timeout=0.02)()
            except queue.Empty:
                continue
