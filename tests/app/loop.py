"""A page's thread, for tests without a page."""

import queue
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import cutcell
from cutcell.rig import Rig
from cutcell_app.document.session import Session

NEVER = 900.0
"""Seconds after which something counts as failed, also on a machine with much else to do."""


def wait_until(condition: Callable[[], bool], seconds: float = NEVER) -> None:
    """Wait for something that happens in other threads or processes; fail if it never does."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not come about in time"
        time.sleep(0.02)


class Loop:
    """Collects what is scheduled, from any thread, and runs it here."""

    def __init__(self) -> None:
        self._actions: queue.Queue[Callable[[], None]] = queue.Queue()

    def __call__(self, action: Callable[[], None]) -> None:
        self._actions.put(action)

    def run_until(self, condition: Callable[[], bool], seconds: float = NEVER) -> None:
        """Run actions until something holds; fail if it never does."""
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, "it did not come about in time"
            try:
                self._actions.get(timeout=0.02)()
            except queue.Empty:
                continue

    def rest(self, session: Session) -> None:
        """Run actions until a session has no work left."""
        ends: list[bool] = []

        def end() -> None:
            if session.work.busy:  # what was scheduled before this has begun more work
                session.work.when_idle(end)
            else:
                ends.append(True)

        session.work.when_idle(end)
        self.run_until(lambda: bool(ends))

    def run_out(self) -> None:
        """Run actions until the threads of all jobs have ended and nothing is scheduled."""
        self.run_until(lambda: all(one.name != "cutcell job" for one in threading.enumerate()))
        while not self._actions.empty():
            self._actions.get()()

    def run_for(self, seconds: float) -> None:
        """Run whatever comes within some time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                self._actions.get(timeout=0.02)()
            except queue.Empty:
                continue


def settled(session: Session, loop: Loop) -> None:
    """Run until a session has no work left; check that nothing went wrong."""
    loop.rest(session)
    assert session.state.message is None, session.state.message


def check_bound_as_by_core(session: Session, rig: Rig, **options: Any) -> None:
    """Check that a session's weights are those that the core binds, with its edits."""
    state = session.state
    fresh = cutcell.bind(rig, state.resolution, edits=state.edits, **options)
    np.testing.assert_allclose(state.binding.weights, fresh.weights, rtol=0, atol=1e-9)
