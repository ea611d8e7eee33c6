"""Work on all cores, by threads that run kernels without Python's lock.

numba's own parallel loops are not used: where its threading layer is the plain one, two
threads that start such a loop at once, say two sessions of the page, end the process.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import TypeVar

import numba

Item = TypeVar("Item")
Result = TypeVar("Result")


def threads() -> int:
    """Return how many threads kernels run on; NUMBA_NUM_THREADS sets it."""
    return int(getattr(numba.config, "NUMBA_NUM_THREADS"))  # noqa: B009


def in_threads(work: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """Apply `work`, which should spend its time in nogil kernels, to each item."""
    with ThreadPoolExecutor(threads()) as pool:
        return list(pool.map(work, items))


def parts(count: int, at_once: int = 0) -> list[slice]:
    """Cut `count` items into slices, more than there are threads, so that none idles."""
    pieces = max(1, min(count, at_once or 4 * threads()))
    bounds = [count * k // pieces for k in range(pieces + 1)]
    return [slice(a, b) for a, b in pairwise(bounds)]
