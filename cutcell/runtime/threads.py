"""Parallel work by threads that run kernels without Python's lock.

numba's own parallel loops are not used: with its plain threading layer the process ends when two
threads, say two sessions of the page, start such a loop at once.
"""

import os
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextvars import copy_context
from functools import cache
from itertools import pairwise
from typing import Any, TypeVar
from weakref import WeakSet

import numba

from ..errors import Cancelled
from .progress import Progress, silent

Item = TypeVar("Item")
Result = TypeVar("Result")
Second = TypeVar("Second")

POLL_EVERY = 0.1
"""Seconds between two repeated reports."""
MAX_ABANDONED = 3
"""Largest number of threads whose cancelled work still runs."""

_thread = threading.local()
_abandoned: WeakSet[threading.Thread] = WeakSet()


def threads() -> int:
    """Return how many threads kernels run on; NUMBA_NUM_THREADS sets it."""
    return int(getattr(numba.config, "NUMBA_NUM_THREADS"))  # noqa: B009


def in_threads(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    report: Callable[[float], None] = lambda done: None,
) -> list[Result]:
    """Apply `work`, which should spend its time in nogil kernels, to each item in parallel.

    The calling thread takes part, and does not wait for a thread that has not started: small work
    takes less time than waking one. Nested calls run in the thread that makes them.
    """
    items = list(items)
    results: dict[int, Result] = {}
    waiting, telling = iter(enumerate(items)), threading.Lock()

    def take() -> None:
        try:
            for index, item in waiting:
                results[index] = work(item)
                with telling:
                    report(len(results) / len(items))
        except BaseException:
            for _ in waiting:  # leave none to the others
                pass
            raise

    if len(items) < 2 or threads() < 2 or getattr(_thread, "is_worker", False):
        take()
        return [results[index] for index in range(len(items))]
    helpers = [_pool(threads() - 1).submit(take) for _ in range(min(threads(), len(items)) - 1)]
    _thread.is_worker = True
    try:
        take()
    finally:
        _thread.is_worker = False
        started = [helper for helper in helpers if not helper.cancel()]
        for helper in started:
            helper.exception()  # wait for all, whatever one of them raises
    for helper in started:
        helper.result()
    return [results[index] for index in range(len(items))]


def run_parallel(one: Callable[[], Result], other: Callable[[], Second]) -> tuple[Result, Second]:
    """Run two functions in parallel, see `in_threads`; return both results."""
    results: list[Any] = in_threads(lambda task: task(), (one, other))
    return results[0], results[1]


def submit(work: Callable[[], Result]) -> Callable[[], Result]:
    """Run a function in another thread; return a function that waits for its result.

    If no thread has started it by then, it runs in the thread that waits.
    """
    if threads() < 2 or getattr(_thread, "is_worker", False):
        return work
    task = _pool(threads() - 1).submit(work)
    return lambda: work() if task.cancel() else task.result()


def cancellable(work: Callable[[Progress], Result], progress: Progress, first_stage: str) -> Result:
    """Do work that can be cancelled at any moment, however long its steps take.

    The work runs in a thread of its own. The calling thread repeats the last report ten times a
    second, and passes on at once what `progress` raises. The work then ends at its next report,
    with no one waiting for it. While `MAX_ABANDONED` such threads run, new work waits.
    """
    is_inner = getattr(_thread, "is_worker", False) or getattr(_thread, "is_run", False)
    if progress is silent or is_inner:
        return work(progress)
    relay, result = _Relay(progress, first_stage), Future[Result]()
    context = copy_context()

    def run() -> None:
        _thread.is_run = True
        try:
            result.set_result(context.run(work, relay.report))
        except BaseException as error:
            result.set_exception(error)

    runner = threading.Thread(target=run, name="cutcell-work", daemon=True)
    try:
        while sum(thread.is_alive() for thread in _abandoned) >= MAX_ABANDONED:
            relay.repeat()
            time.sleep(POLL_EVERY)
        runner.start()
        while not wait([result], POLL_EVERY).done:
            relay.repeat()
        return result.result()
    finally:
        relay.is_over = True
        _abandoned.add(runner)


class _Relay:
    """Reports of one thread, repeated by another, until it is over."""

    def __init__(self, progress: Progress, stage: str) -> None:
        self.is_over = False
        self._progress = progress
        self._last = stage, 0.0
        self._lock = threading.Lock()

    def report(self, stage: str, fraction: float) -> None:
        """Pass a report on."""
        with self._lock:
            if self.is_over:
                raise Cancelled
            self._last = stage, fraction
            self._progress(stage, fraction)

    def repeat(self) -> None:
        """Report the last one again, unless one is being passed on."""
        if self._lock.acquire(blocking=False):
            try:
                self._progress(*self._last)
            finally:
                self._lock.release()


def parts(count: int, at_once: int = 0) -> list[slice]:
    """Divide `count` items into slices, more than there are threads, so that none idles."""
    pieces = max(1, min(count, at_once or 4 * threads()))
    bounds = [count * k // pieces for k in range(pieces + 1)]
    return [slice(a, b) for a, b in pairwise(bounds)]


@cache
def _pool(count: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(count, "cutcell", setattr, (_thread, "is_worker", True))


# A forked process would inherit the pool, but none of its threads.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)
