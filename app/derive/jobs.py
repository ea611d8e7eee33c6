"""Work off the event loop, with progress; stopped work does not arrive any more."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from typing import Any

from cutcell.errors import Cancelled
from cutcell.runtime.progress import Progress

Schedule = Callable[[Callable[[], Any]], Any]
"""Runs a function later, on the thread that owns the page. Called from any thread."""

Pool = Callable[[Callable[[], None]], Any]
"""Runs a function beside the thread that owns the page."""

PATIENCE = 1.0
"""Seconds that others wait for cancelled work that has not noticed it yet."""

MAX_UNRESPONSIVE = 3
"""Largest number of such jobs beside those that are needed; then others wait nevertheless."""


class Slots:
    """Limit of how many jobs of one kind run at once, over all sessions."""

    def __init__(self, places: int = 1) -> None:
        self._places = places
        self._change = threading.Condition()
        self._running: set[Job] = set()

    def take(self, job: Job, seconds: float) -> bool:
        """Take a slot; False where none became free within some seconds."""
        with self._change:
            free = self._change.wait_for(self._free, seconds)
            if free:
                self._running.add(job)
            return free

    def give_back(self, job: Job) -> None:
        """Free the slot of a job."""
        with self._change:
            self._running.discard(job)
            self._change.notify_all()

    def _free(self) -> bool:
        now = time.monotonic()
        unresponsive = sum(now - job.stopped > PATIENCE for job in self._running)
        return len(self._running) - min(unresponsive, MAX_UNRESPONSIVE) < self._places


COMPUTING = Slots()
"""Binding takes all cores and much memory: sessions compute in turn."""

COMPARING = Slots(4)
"""Methods that are compared may take minutes, most of them in processes of their own: some
sessions do so at once, so that none waits for another's slow method."""

DRAWING = Slots()
"""Pictures and films are drawn in turn, while others compute."""

DESCRIBING = Slots(4)
"""Scenes of large characters are described while others compute."""

READING = Slots(4)
"""Files are read in processes of their own, while others compute."""

WAITING = "waiting for another computation"
"""The stage of work that waits for its turn."""

REPORT_EVERY = 0.08
"""Seconds between two reports of progress; more would only keep the page busy."""


def on_its_thread(document: Any, loop: Any) -> Schedule:
    """Return a function that schedules functions on a document's own thread, from any thread.

    `document.add_next_tick_callback` alone will not do: called from another thread in the very
    moment in which the document lets go of the changes that it held together, it is put with
    them, and waits until something else is changed. `loop` is that of the document's thread.
    """

    def add(action: Callable[[], Any]) -> None:
        if document.session_context is not None:  # else its browser is gone
            document.add_next_tick_callback(action)

    return lambda action: loop.add_callback(add, action)


class Gate:
    """Holds scheduled actions back until a page is there to show what they do.

    Changes while a browser is still loading may arrive in the wrong order.
    """

    def __init__(self, schedule: Schedule) -> None:
        self._schedule = schedule
        self._waiting: list[Callable[[], Any]] | None = []
        self._lock = threading.Lock()

    def __call__(self, action: Callable[[], Any]) -> None:
        """Schedule an action, now or when the gate opens; from any thread."""
        with self._lock:
            if self._waiting is not None:
                self._waiting.append(action)
                return
        self._schedule(action)

    def open(self) -> None:
        """Schedule all that waits, in order."""
        with self._lock:
            waiting, self._waiting = self._waiting or [], None
            for action in waiting:
                self._schedule(action)


def in_thread(action: Callable[[], None]) -> None:
    """Run a function in a new thread."""
    threading.Thread(target=action, daemon=True, name="cutcell job").start()


class Job:
    """One piece of work; `done`, `failed` and `report` run on the page's own thread.

    Parameters
    ----------
    schedule : callable
        See `Schedule`.
    work : callable
        Takes a function that reports progress, which raises `Cancelled` in stopped work.
    done, failed : callable
        Take the result, or the error.
    report : callable
        See `cutcell.runtime.progress`.
    slots : Slots
    """

    def __init__(
        self,
        schedule: Schedule,
        work: Callable[[Progress], Any],
        done: Callable[[Any], None],
        failed: Callable[[Exception], None],
        report: Progress,
        slots: Slots,
    ) -> None:
        self.cancelled = threading.Event()
        self.stopped = math.inf
        self._schedule, self._work, self._slots = schedule, work, slots
        self._done, self._failed, self._report = done, failed, report
        self._last = ("", 0.0)

    def cancel(self) -> None:
        """Stop it, as soon as it looks; none of its results arrive any more."""
        self.stopped = time.monotonic()
        self.cancelled.set()

    def progress(self, stage: str, fraction: float) -> None:
        """Report to the page, or stop the work when it was cancelled."""
        if self.cancelled.is_set():
            raise Cancelled
        now = time.monotonic()
        if stage != self._last[0] or now - self._last[1] >= REPORT_EVERY:
            self._last = (stage, now)
            self._later(lambda: self._report(stage, fraction))

    def run(self) -> None:
        """Do the work, once a slot is free."""
        try:
            while not self._slots.take(self, 0.05):
                self.progress(WAITING, 0.0)
            try:
                result = self._work(self.progress)
            finally:
                self._slots.give_back(self)
        except Exception as error:  # whatever it is, the page must hear of it
            if isinstance(error, Cancelled) and self.cancelled.is_set():
                return
            problem = error
            self._later(lambda: self._failed(problem))
        else:
            self._later(lambda: self._done(result))

    def _later(self, action: Callable[[], None]) -> None:
        self._schedule(lambda: None if self.cancelled.is_set() else action())
