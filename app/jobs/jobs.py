"""Work off the event loop: one at a time, with progress, stoppable, newest first."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

from cutcell.errors import Cancelled
from cutcell.runtime.progress import Progress, silent

Schedule = Callable[[Callable[[], Any]], Any]
"""Runs a function later, on the thread that owns the page."""

PATIENCE = 1.0
"""Seconds that others wait for cancelled work that has not noticed it yet."""

MAX_UNRESPONSIVE = 3
"""Largest number of such jobs beside those that are needed; then others wait nevertheless."""


class Slots:
    """Slots for work of a kind: what finds none free waits.

    Parameters
    ----------
    places : int
        How many.
    """

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
    """Return what runs functions later on a document's own thread; from any thread.

    `document.add_next_tick_callback` alone will not do: called from another thread in the very
    moment in which the document lets go of the changes that it held together, it is put with
    them, and waits until something else is changed.

    Parameters
    ----------
    document : bokeh.document.Document
    loop : tornado.ioloop.IOLoop
        That of the document's thread.
    """

    def add(action: Callable[[], Any]) -> None:
        if document.session_context is not None:  # else its browser is gone
            document.add_next_tick_callback(action)

    return lambda action: loop.add_callback(add, action)


class Gate:
    """Holds scheduled actions back until a page is there to show what they do.

    Changes while a browser is still loading may arrive in the wrong order.

    Parameters
    ----------
    schedule : callable
        What to schedule with once the gate is open.
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


class Job:
    """One piece of work."""

    def __init__(self, schedule: Schedule, report: Progress) -> None:
        self.cancelled = threading.Event()
        self.stopped = math.inf
        self._schedule = schedule
        self._report = report
        self._last = ("", 0.0)

    def cancel(self) -> None:
        """Stop it, as soon as it looks."""
        self.stopped = time.monotonic()
        self.cancelled.set()

    def progress(self, stage: str, fraction: float) -> None:
        """Report to the page, or stop the work when it was cancelled."""
        if self.cancelled.is_set():
            raise Cancelled
        now = time.monotonic()
        if stage != self._last[0] or now - self._last[1] >= REPORT_EVERY:
            self._last = (stage, now)
            self.later(lambda: self._report(stage, fraction))

    def later(self, action: Callable[[], None]) -> None:
        """Run an action on the page's own thread, unless the job is stopped till then."""
        self._schedule(lambda: None if self.cancelled.is_set() else action())

    def wait_for(self, slots: Slots) -> None:
        """Wait until no other session, or few enough of them, do work of the kind."""
        while not slots.take(self, 0.05):
            self.progress(WAITING, 0.0)


class Jobs:
    """The work of one session; starting one stops the one before.

    Parameters
    ----------
    schedule : callable
        Runs a function on the page's own thread, soon. Called from any thread.
    """

    def __init__(self, schedule: Schedule) -> None:
        self._schedule = schedule
        self._current: Job | None = None
        self._closed = False

    @property
    def running(self) -> bool:
        """Whether there is work that was neither finished nor stopped."""
        return self._current is not None

    def start(
        self,
        work: Callable[[Progress], Any],
        done: Callable[[Any], None],
        failed: Callable[[Exception], None],
        report: Progress,
        slots: Slots = COMPUTING,
    ) -> Job | None:
        """Do some work in a thread; `done`, `failed` and `report` run on the page's thread.

        It waits until no other session, or few enough of them, do work of the same kind.
        Whatever ran before is stopped, and none of its results arrive any more.
        """
        self.cancel()
        if self._closed:
            return None
        job = self._current = Job(self._schedule, report)
        ends = (self._finishing(job, done), self._finishing(job, failed))
        arguments = (job, work, *ends, slots)
        threading.Thread(target=_run, args=arguments, daemon=True, name="cutcell job").start()
        return job

    def cancel(self) -> bool:
        """Stop what runs; return whether there was anything to stop."""
        job, self._current = self._current, None
        if job is not None:
            job.cancel()
        return job is not None

    def close(self) -> None:
        """Stop what runs, and start nothing any more."""
        self._closed = True
        self.cancel()

    def _finishing(self, job: Job, action: Callable[[Any], None]) -> Callable[[Any], None]:
        def finish(value: Any) -> None:
            if self._current is job:
                self._current = None
            action(value)

        return finish


class Newest:
    """Work that is requested again while it runs: one at a time, and next only the last request.

    Requests of a dragged slider would otherwise pile up, since running work does not check if it
    is still wanted.

    Parameters
    ----------
    jobs : Jobs
    failed : callable
        Called on the page's thread with what goes wrong.
    """

    def __init__(self, jobs: Jobs, failed: Callable[[Exception], None]) -> None:
        self._jobs = jobs
        self._failed = failed
        self._next: tuple[Callable[[Progress], Any], Callable[[Any], None]] | None = None

    def do(self, work: Callable[[Progress], Any], done: Callable[[Any], None]) -> None:
        """Do some work, now or after the running one; `done` runs on the page's thread."""
        if self._jobs.running:
            self._next = (work, done)
            return

        def then(act: Callable[[Any], None], value: Any) -> None:
            try:
                act(value)
            finally:
                waiting, self._next = self._next, None
                if waiting is not None and not self._jobs.running:
                    self.do(*waiting)

        ends = (partial(then, done), partial(then, self._failed))
        self._jobs.start(work, *ends, silent, DESCRIBING)

    def cancel(self) -> None:
        """Cancel the running work, and drop the waiting one."""
        self._next = None
        self._jobs.cancel()


def _run(
    job: Job,
    work: Callable[[Progress], Any],
    done: Callable[[Any], None],
    failed: Callable[[Exception], None],
    slots: Slots,
) -> None:
    try:
        job.wait_for(slots)
        try:
            result = work(job.progress)
        finally:
            slots.give_back(job)
    except Cancelled:
        return
    except Exception as error:  # whatever it is, the page must hear of it
        problem = error
        job.later(lambda: failed(problem))
    else:
        job.later(lambda: done(result))
