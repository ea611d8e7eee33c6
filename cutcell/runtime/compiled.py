"""How functions are compiled by numba, and kept."""

from collections.abc import Callable
from typing import Any

from numba import njit
from numba.core.dispatcher import Dispatcher

from .compile_cache import CompileCache


def compiled(function: Callable | None = None, **options: Any) -> Any:
    """Compile a function that runs without Python's lock, and keep it (`compile_cache`).

    A division by zero gives infinity: a check for it that raises an error would take a branch.
    """
    if function is None:
        return lambda function: compiled(function, **options)
    options = {"nogil": True, "no_cfunc_wrapper": True, "error_model": "numpy", **options}
    dispatcher = njit(**options)(function)
    if isinstance(dispatcher, Dispatcher):  # it is a plain function under NUMBA_DISABLE_JIT
        dispatcher._cache = CompileCache(function)  # type: ignore[attr-defined]
    return dispatcher


def no_refcount(function: Callable) -> Callable:
    """Compile a function without reference counting: it makes no array and returns none.

    numba counts references to arrays. To read an array from a tuple, or a row of one, is then an
    atomic addition, which costs more than the work on the row, and more still while another thread
    counts, too. The caller keeps the arrays alive anyhow.
    """
    return compiled(function, _nrt=False)


def inlined(function: Callable) -> Callable:
    """Compile a small function as by `no_refcount`, to be inlined by LLVM wherever it is called.

    numba's own inlining would have its types inferred anew in each place, which takes longer than
    all the rest.
    """
    return compiled(function, _nrt=False, forceinline=True)


@inlined
def copy_to(values, target):
    """Copy the entries of an array (n,) to the start of one that is at least as long.

    For an assignment to a slice numba first compiles the text of an error, which takes seconds.
    """
    for i in range(len(values)):
        target[i] = values[i]


def vectorized(function: Callable) -> Callable:
    """Compile a function without reference counting whose loop is to be vectorised.

    A product may be added without being rounded first (fused multiply-add).
    """
    return compiled(function, _nrt=False, fastmath={"contract"})
