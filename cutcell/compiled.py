"""How kernels are compiled."""

from collections.abc import Callable
from typing import Any

from numba import njit
from numba.core.dispatcher import Dispatcher

from .kernel_cache import KernelCache


def compiled(kernel: Callable | None = None, **options: Any) -> Any:
    """Compile a kernel that runs without Python's lock, and keep it (`kernel_cache`).

    Parameters
    ----------
    kernel : callable
        Left out where the decorator is used with options.
    **options
        Of `numba.njit`.
    """
    if kernel is None:
        return lambda kernel: compiled(kernel, **options)
    dispatcher = njit(nogil=True, **options)(kernel)
    if isinstance(dispatcher, Dispatcher):  # it is a plain function under NUMBA_DISABLE_JIT
        dispatcher._cache = KernelCache(kernel)  # type: ignore[attr-defined]
    return dispatcher


def lean(kernel: Callable) -> Callable:
    """Compile a kernel that makes no array and returns none.

    numba counts who holds an array. To read one from a tuple or to take a row of one is then an
    atomic addition, dearer than what is done with the row, and dearer still while another
    thread counts, too. Whoever calls the kernel holds its arrays anyhow.
    """
    return compiled(kernel, _nrt=False)


@compiled(inline="always")
def put(values, place):
    """Copy the entries of an array (n,) into one at least as long.

    To assign to a slice, numba first compiles the words of an error for seconds.
    """
    for i in range(len(values)):
        place[i] = values[i]


def side_by_side(kernel: Callable) -> Callable:
    """Compile a lean kernel whose loop is to run in the lanes of vector instructions.

    To divide by zero gives infinity there: to look out for it and raise an error takes a branch.
    A product may be added without being rounded first.
    """
    return compiled(kernel, _nrt=False, error_model="numpy", fastmath={"contract"})
