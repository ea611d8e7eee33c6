"""Work of one page off its own thread, by name; and whether any of it runs."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from functools import partial
from typing import Any

from cutcell.errors import Cancelled
from cutcell.runtime.progress import Progress, silent

from .jobs import COMPUTING, DESCRIBING, Job, Pool, Schedule, Slots, in_thread

PAUSE = 0.2
"""Seconds without a change after which a person is taken to have chosen."""

Clock = Callable[[float, Callable[[], None]], Callable[[], Any]]
"""Calls a function after some seconds, in any thread; returns a function that prevents it."""


def on_the_clock(seconds: float, action: Callable[[], None]) -> Callable[[], Any]:
    """Call a function after some seconds; see `Clock`."""
    timer = threading.Timer(seconds, action)
    timer.daemon = True
    timer.start()
    return timer.cancel


class Work:
    """Work of one page, by name.

    All methods are called on the page's own thread, but for `later`.

    Parameters
    ----------
    schedule : callable
        See `Schedule`.
    failed : callable
        Takes what goes wrong.
    reported : callable
        Called when `progress` has changed.
    pool : callable
        See `Pool`.
    clock : callable
        See `Clock`.

    Attributes
    ----------
    progress : dict
        Stage and fraction of all work whose progress is shown, by name.
    """

    def __init__(
        self,
        schedule: Schedule,
        failed: Callable[[Exception], None],
        reported: Callable[[], None] = lambda: None,
        pool: Pool = in_thread,
        clock: Clock = on_the_clock,
    ) -> None:
        self._schedule, self._failed, self._reported = schedule, failed, reported
        self._pool, self._clock = pool, clock
        self._jobs: dict[Hashable, Job] = {}
        self._next: dict[Hashable, Callable[[], None]] = {}
        self._pauses: dict[Hashable, tuple[object, Callable[[], Any]]] = {}
        self.progress: dict[Hashable, tuple[str, float]] = {}
        self._when_idle: list[Callable[[], Any]] = []
        self.closed = False

    def start(
        self,
        name: Hashable,
        work: Callable[[Progress], Any],
        done: Callable[[Any], None],
        failed: Callable[[], None] = lambda: None,
        slots: Slots = COMPUTING,
        report: Progress | None = None,
    ) -> None:
        """Do some work in another thread; it replaces running work of the same name.

        `done` gets its result. An error is reported, and then `failed` is called. Where `report` is
        left out, the page shows the progress.
        """
        self.cancel(name)
        if self.closed:
            return

        def end(action: Callable[[Any], None], value: Any) -> None:
            del self._jobs[name]
            self._report(name, None)
            try:
                action(value)
            finally:
                self._next.pop(name, lambda: None)()
                self.rest()

        if report is None:

            def report(stage: str, fraction: float) -> None:
                self._report(name, (stage, fraction))

            report("", 0.0)
        ends = partial(end, done), partial(end, lambda error: self.fail(error, failed))
        self._jobs[name] = Job(self.later, work, *ends, report, slots)
        self._pool(self._jobs[name].run)

    def fail(self, error: Exception, failed: Callable[[], None]) -> None:
        """Report an error of work, and then call `failed`."""
        self._failed(error)
        failed()

    def newest(
        self, name: Hashable, work: Callable[[Progress], Any], done: Callable[[Any], None]
    ) -> None:
        """Do some work, after work of the same name that runs; only the last request waits.

        Requests of a dragged slider would otherwise pile up, or none would ever be completed.
        """
        begin = partial(self.start, name, work, done, slots=DESCRIBING, report=silent)
        if name in self._jobs:
            self._next[name] = begin
        else:
            begin()

    def is_running(self, name: Hashable) -> bool:
        """Return whether work of a name runs."""
        return name in self._jobs

    def running(self) -> frozenset[Hashable]:
        """Return the names of all work that runs."""
        return frozenset(self._jobs)

    def cancel(self, name: Hashable) -> bool:
        """Stop work of a name, and drop what waits for it; return whether any ran."""
        self._next.pop(name, None)
        job = self._jobs.pop(name, None)
        if job is not None:
            job.cancel()
            self._report(name, None)
        return job is not None

    def later(self, action: Callable[[], Any]) -> None:
        """Run an action on the page's thread, from any thread; its errors are reported."""

        def guarded() -> None:
            try:
                action()
            except Cancelled:
                return
            except Exception as error:
                self._failed(error)

        self._schedule(guarded)

    def after_a_pause(self, action: Callable[[], Any], name: Hashable) -> None:
        """Run an action when choices have rested; a newer one of the same name takes its place."""
        self.cancel_pause(name)
        if self.closed:
            return
        token = object()

        def act() -> None:
            if self._pauses.get(name, (None,))[0] is token:
                del self._pauses[name]
                action()
                self.rest()

        self._pauses[name] = (token, self._clock(PAUSE, lambda: self.later(act)))

    def cancel_pause(self, name: Hashable) -> None:
        """Drop an action that waits for a pause."""
        self._pauses.pop(name, (None, lambda: None))[1]()

    @property
    def busy(self) -> bool:
        """Whether anything runs, or is about to."""
        return bool(self._jobs or self._next or self._pauses)

    def when_idle(self, action: Callable[[], Any]) -> None:
        """Call a function once, when nothing runs any more."""
        self._when_idle.append(action)
        self.rest()

    def rest(self) -> None:
        """Call what waits until nothing runs, if that is so."""
        if self._when_idle and not self.busy:
            actions, self._when_idle = self._when_idle, []
            for action in actions:
                self.later(action)

    def close(self) -> None:
        """Stop all work, and start nothing any more."""
        self.closed = True
        for name in [*self._jobs]:
            self.cancel(name)
        for name in [*self._pauses]:
            self.cancel_pause(name)

    def _report(self, name: Hashable, progress: tuple[str, float] | None) -> None:
        before = self.progress.get(name)
        if progress is None:
            self.progress.pop(name, None)
        else:
            self.progress[name] = progress
        if progress != before:
            self._reported()
