"""Compile all functions of a binding at once, so that no character waits for one of them."""

import gc
import logging
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import numpy as np

from ..geodesics import bone_distances
from ..graph import CutCellGraph, build_graph
from ..method import ANIMATION, RIG_REACH
from ..runtime import compile_cache
from ..runtime.subprocesses import python_environment
from ..runtime.threads import threads
from .skinning_weights import skinning_weights
from .warm_up_inputs import block_graph, chain, tube

_is_warm = False


def warm_up() -> None:
    """Bind small meshes, so that every compiled function is called with the types it meets.

    They are compiled once on a machine (about a minute, in two processes) and kept on disk, see
    `compile_cache`; from there a process loads them in about a second. Where they cannot be kept,
    each process compiles them in memory, and one sentence is logged.
    """
    global _is_warm
    is_complete = compile_cache.is_complete()
    with nullcontext() if is_complete else _without_garbage_collection():
        with nullcontext() if is_complete else _helper_process("compile_after_graph"):
            graphs = [build_graph(tube(), 8, connectivity=kind) for kind in ("any", 26)]
        for graph in graphs:
            _compile_after(graph)
    _is_warm = True
    if not is_complete:
        compile_cache.mark_complete()
        if compile_cache.refusals:
            logging.getLogger("cutcell").warning(
                "the compiled functions cannot be kept (%s), so that each start takes a minute or "
                "two; set NUMBA_CACHE_DIR to a folder that can be written to",
                compile_cache.refusals[-1],
            )


def compile_after_graph() -> None:
    """Compile what a binding needs once it has its graph, which takes about as long as that."""
    with _without_garbage_collection():
        _compile_after(block_graph())


@contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """Do not look for garbage: a compiler makes millions of objects, and looks every moment."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _compile_after(graph: CutCellGraph) -> None:
    methods = ANIMATION, ANIMATION.with_options(falloff="paper")
    for method in methods:  # which measure from different numbers of joints
        distances = bone_distances(graph, chain(), method=method, leaf="fit", within=RIG_REACH)
    for method in (*methods, ANIMATION.with_options(refine="learned")):
        skinning_weights(distances, method=method)
    every = np.ones(distances.joint.shape[::-1], bool)
    skinning_weights(distances, method=method, allowed=every)


@contextmanager
def _helper_process(function: str) -> Iterator[None]:
    """Let another process call a function of this module meanwhile; wait for it at the end.

    Only one thread of a process can compile. What that process fails to do is left to this one.
    """
    if not _can_be_helped():
        yield
        return
    code = f"from cutcell.weights import warm_up; warm_up.{function}()"
    command = [sys.executable, "-c", code]
    nothing = subprocess.DEVNULL
    try:
        process = subprocess.Popen(
            command, env=python_environment(), stdin=nothing, stdout=nothing, stderr=nothing
        )
    except OSError:
        yield
        return
    with process:
        try:
            yield
            process.wait()
        finally:
            process.kill()


def _can_be_helped() -> bool:
    """Return whether another process can start, and hand over what it compiles."""
    # A program that Python is built into could start itself once more.
    is_python = Path(sys.executable or "").stem.lower().startswith("python")
    return is_python and threads() > 1 and compile_cache.write("begun", b"") is not None


def is_compiled() -> bool:
    """Return whether all functions, as they now are, are compiled: in memory or on this machine."""
    return _is_warm or compile_cache.is_complete()
