"""Work on all cores, by threads that run kernels without Python's lock.

numba's own parallel loops are not used: where its threading layer is the plain one, two
threads that start such a loop at once, say two sessions of the page, end the process.
"""

import os
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from functools import cache
from itertools import pairwise
from typing import Any, TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

Item = TypeVar("Item")
Result = TypeVar("Result")
Second = TypeVar("Second")

TELL_EVERY = 0.1
"""Seconds between two looks at a long kernel."""
MANY_STEPS = 50_000
"""A kernel of fewer is done before it would be looked at."""

_here = threading.local()


def threads() -> int:
    """Return how many threads kernels run on; NUMBA_NUM_THREADS sets it."""
    return int(getattr(numba.config, "NUMBA_NUM_THREADS"))  # noqa: B009


def in_threads(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    tell: Callable[[float], None] = lambda done: None,
) -> list[Result]:
    """Apply `work`, which should spend its time in nogil kernels, to each item.

    The calling thread works, too, and waits for no other that has not begun: small work is done
    in less time than it takes to wake one. Work that calls for threads itself runs in its own.

    Parameters
    ----------
    work : callable
    items : iterable
    tell : callable
        Told the fraction that is done after each item, by one thread at a time. What it raises goes
        through, and ends the work.
    """
    items = list(items)
    results: dict[int, Result] = {}
    waiting, telling = iter(enumerate(items)), threading.Lock()

    def take() -> None:
        try:
            for place, item in waiting:
                results[place] = work(item)
                with telling:
                    tell(len(results) / len(items))
        except BaseException:
            for _ in waiting:  # nobody takes another
                pass
            raise

    if len(items) < 2 or threads() < 2 or getattr(_here, "is_worker", False):
        take()
        return [results[place] for place in range(len(items))]
    helpers = [_pool(threads() - 1).submit(take) for _ in range(min(threads(), len(items)) - 1)]
    _here.is_worker = True
    try:
        take()
    finally:
        _here.is_worker = False
        begun = [helper for helper in helpers if not helper.cancel()]
        for helper in begun:
            helper.exception()  # wait for all, whatever one of them raises
    for helper in begun:
        helper.result()
    return [results[place] for place in range(len(items))]


def together(one: Callable[[], Result], other: Callable[[], Second]) -> tuple[Result, Second]:
    """Do two things at the same time, each in a thread of its own; see `in_threads`."""
    results: list[Any] = in_threads(lambda task: task(), (one, other))
    return results[0], results[1]


def meanwhile(work: Callable[[], Result]) -> Callable[[], Result]:
    """Begin something on another core; return a function that waits for it and gives its result.

    What no core has begun by then is done by whoever asks.
    """
    if threads() < 2 or getattr(_here, "is_worker", False):
        return work
    task = _pool(threads() - 1).submit(work)
    return lambda: work() if task.cancel() else task.result()


def watched(
    work: Callable[[NDArray[np.int64]], Result], steps: int, tell: Callable[[float], None]
) -> Result:
    """Tell how far a long kernel is, ten times a second, and let it be stopped.

    Parameters
    ----------
    work : callable
        Calls the kernel, with an array of two numbers: the kernel writes to the first how many
        steps it has done, and returns early, with anything, once the second is not 0.
    steps : int
        How many there are.
    tell : callable
        Told the fraction that is done. What it raises goes through, and stops the kernel.
    """
    pace = np.zeros(2, np.int64)
    if steps < MANY_STEPS:
        return work(pace)
    result: Future[Result] = Future()

    def run() -> None:
        _mark_worker()
        try:
            result.set_result(work(pace))
        except BaseException as error:
            result.set_exception(error)

    runner = threading.Thread(target=run, name="cutcell-watched")
    runner.start()
    try:
        while True:
            if wait([result], TELL_EVERY).done:
                return result.result()
            tell(pace[0] / steps)
    finally:
        pace[1] = 1
        runner.join()


def parts(count: int, at_once: int = 0) -> list[slice]:
    """Cut `count` items into slices, more than there are threads, so that none idles."""
    pieces = max(1, min(count, at_once or 4 * threads()))
    bounds = [count * k // pieces for k in range(pieces + 1)]
    return [slice(a, b) for a, b in pairwise(bounds)]


@cache
def _pool(count: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(count, "cutcell", initializer=_mark_worker)


def _mark_worker() -> None:
    _here.is_worker = True


# A forked process would inherit the pool, but none of its threads.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)
