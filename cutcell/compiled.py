"""How the innermost kernels are compiled."""

from collections.abc import Callable
from typing import Any

from numba import njit


def lean(kernel: Callable) -> Callable:
    """Compile a kernel that makes no array and returns none.

    numba counts who holds an array. To read one from a tuple or to take a row of one is then an
    atomic addition, dearer than what is done with the row, and dearer still while another
    thread counts, too. Whoever calls the kernel holds its arrays anyhow.
    """
    options: Any = {"cache": True, "nogil": True, "_nrt": False}
    return njit(**options)(kernel)
