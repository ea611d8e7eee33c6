"""Compile all functions of a binding at once, so that no character waits for one of them."""

import gc
import logging
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from functools import cache
from pathlib import Path

import numpy as np

from ..geodesics import bone_distances
from ..graph import build_graph
from ..method import ANIMATION
from ..runtime import compile_cache
from ..runtime.subprocesses import python_environment
from .skinning_weights import skinning_weights
from .warm_up_inputs import chain, tube


@cache
def warm_up() -> None:
    """Bind small meshes, so that every compiled function is called with the types it meets.

    They are compiled once on a machine and kept on disk, see `compile_cache`; from there a process
    loads them in about a second. Where they cannot be kept, each process compiles them in memory,
    and a warning is logged.
    """
    with nullcontext() if compile_cache.is_complete() else compile_cache.only_process():
        is_complete = compile_cache.is_complete()
        with _without_garbage_collection():
            _bind_small()
        if not is_complete:
            compile_cache.mark_complete()
    if compile_cache.refusals and not is_complete:
        logging.getLogger("cutcell").warning(
            "the compiled functions cannot be kept (%s), so that each start takes about half a "
            "minute; set NUMBA_CACHE_DIR to a folder that can be written to",
            compile_cache.refusals[-1],
        )


def is_compiled() -> bool:
    """Return whether all functions, as they now are, are compiled: in memory or on this machine."""
    return warm_up.cache_info().currsize > 0 or compile_cache.is_complete()


def start_process() -> subprocess.Popen | None:
    """Compile in another process, which ends with the result's `stdin`.

    None where no process can start, or hand over what it compiles.
    """
    # A program that Python is built into could start itself once more.
    is_python = Path(sys.executable or "").stem.lower().startswith("python")
    if not is_python or compile_cache.write("begun", b"") is None:
        return None
    code = f"import {__name__} as module; module._end_with_parent(); module.warm_up()"
    nothing = subprocess.DEVNULL
    with suppress(OSError):
        return subprocess.Popen(
            [sys.executable, "-c", code], env=python_environment(),
            stdin=subprocess.PIPE, stdout=nothing, stderr=nothing,
        )  # fmt: skip
    return None


def _end_with_parent() -> None:
    """End this process when its standard input ends."""

    def wait() -> None:
        sys.stdin.read()
        os._exit(0)

    threading.Thread(target=wait, daemon=True).start()


def _bind_small() -> None:
    """Take every path through a binding."""
    for connectivity in ("any", 26):
        graph = build_graph(tube(), 8, connectivity=connectivity)
        methods = ANIMATION, ANIMATION.with_options(falloff="paper")
        for method in methods:  # which measure from different numbers of joints
            within = ANIMATION.reach_needed
            distances = bone_distances(graph, chain(), method=method, leaf="fit", within=within)
        for method in methods:
            skinning_weights(distances, method=method)
        every = np.ones((len(distances.fallback), distances.rows.shape[1]), bool)
        skinning_weights(distances, method=method, allowed=every)


@contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """Switch garbage collection off: a compiler makes millions of objects that stay."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
