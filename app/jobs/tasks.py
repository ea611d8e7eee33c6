"""All work of one page: jobs by name, and what runs on the page's own thread."""

import threading
from collections.abc import Callable
from typing import Any

from .jobs import Jobs, Newest, Schedule

PAUSE = 0.2
"""Seconds without a change after which a person is taken to have chosen."""


class Tasks:
    """All work of one page, by name.

    Parameters
    ----------
    schedule : callable
        Runs a function on the page's own thread, soon. Called from any thread.
    failed : callable
        Called on that thread with what goes wrong.
    """

    def __init__(self, schedule: Schedule, failed: Callable[[Exception], None]) -> None:
        self._schedule = schedule
        self._failed = failed
        self._jobs: dict[str, Jobs] = {}
        self._newest: dict[str, Newest] = {}
        self._timers: dict[str, threading.Timer] = {}
        self._due: set[str] = set()
        self._closed = False

    def later(self, action: Callable[[], Any]) -> None:
        """Run an action on the page's thread; its errors are reported."""

        def guarded() -> None:
            try:
                action()
            except Exception as error:
                self._failed(error)

        self._schedule(guarded)

    def after_a_pause(self, action: Callable[[], Any], name: str = "choice") -> None:
        """Run an action when a person has paused for a moment; a newer one takes its place.

        Parameters
        ----------
        action : callable
        name : str
            Only actions of one name take each other's place.
        """
        if self._closed:
            return
        if name in self._timers:
            self._timers[name].cancel()

        def act() -> None:
            self._due.discard(name)
            action()

        self._due.add(name)
        timer = self._timers[name] = threading.Timer(PAUSE, lambda: self.later(act))
        timer.daemon = True
        timer.start()

    def is_due(self, name: str) -> bool:
        """Return whether an action waits for a pause."""
        return name in self._due

    def jobs(self, name: str) -> Jobs:
        """Return the work of one name: a newer piece of it stops the one before."""
        if name not in self._jobs:
            self._jobs[name] = Jobs(self.later)
            if self._closed:
                self._jobs[name].close()
        return self._jobs[name]

    def newest(self, name: str) -> Newest:
        """Return the work of one name of which only the newest matters."""
        if name not in self._newest:
            self._newest[name] = Newest(self.jobs(name), self._failed)
        return self._newest[name]

    @property
    def running(self) -> bool:
        """Whether there is work that was neither finished nor stopped, or is about to begin."""
        # The timer may have ended, and its action not have begun.
        waiting = any(timer.is_alive() for timer in self._timers.values())
        return waiting or bool(self._due) or any(jobs.running for jobs in self._jobs.values())

    def close(self) -> None:
        """Stop all work, and start nothing any more."""
        self._closed = True
        self._due.clear()
        for timer in self._timers.values():
            timer.cancel()
        for jobs in self._jobs.values():
            jobs.close()
