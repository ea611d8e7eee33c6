"""Compile all functions of a binding at once, so that no character waits for one of them.

Two processes compile: one from the graph on, the other its winding numbers and then what follows
the graph. The cache lets neither compile what the other has begun.
"""

import gc
import logging
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import numpy as np

from ..geodesics import bone_distances
from ..graph import CutCellGraph, build_graph
from ..graph.winding.boundary import find_boundary
from ..graph.winding.treecode.caps import smallest_caps
from ..graph.winding.treecode.cells import classify_cells
from ..graph.winding.treecode.clusters import build_tree
from ..method import ANIMATION
from ..runtime import compile_cache
from ..runtime.subprocesses import python_environment
from ..runtime.threads import threads
from .skinning_weights import skinning_weights
from .warm_up_inputs import block_graph, chain, tube


@cache
def warm_up() -> None:
    """Bind small meshes, so that every compiled function is called with the types it meets.

    They are compiled once on a machine and kept on disk, see `compile_cache`; from there a process
    loads them in about a second. Where they cannot be kept, each process compiles them in memory,
    and a warning is logged.
    """
    is_complete = compile_cache.is_complete()
    helper = None if is_complete else start_process("compile_from_other_end")
    try:
        with _without_garbage_collection():
            build_graph(tube(), 8, connectivity="any")
            build_graph(tube(), 8, connectivity=26)
            _compile_after(block_graph(26))
            _compile_after(block_graph())
    finally:
        if helper is not None:
            helper.kill()
            helper.communicate()
    if not is_complete:
        compile_cache.mark_complete()
        if compile_cache.refusals:
            logging.getLogger("cutcell").warning(
                "the compiled functions cannot be kept (%s), so that each start takes about a "
                "minute; set NUMBA_CACHE_DIR to a folder that can be written to",
                compile_cache.refusals[-1],
            )


def is_compiled() -> bool:
    """Return whether all functions, as they now are, are compiled: in memory or on this machine."""
    return warm_up.cache_info().currsize > 0 or compile_cache.is_complete()


def compile_from_other_end() -> None:
    """Compile the same in another order: winding numbers, and then what follows the graph."""
    with _without_garbage_collection():
        graph = block_graph()
        caps = smallest_caps(graph.nodes[: graph.first_point], find_boundary(graph.faces))
        classify_cells(build_tree(caps), 8, ANIMATION.winding_threshold)
        _compile_after(graph)
        _compile_after(block_graph(26))


def start_process(function: str) -> subprocess.Popen | None:
    """Call a function of this module in another process, which ends with the result's `stdin`.

    None where no process can start, or hand over what it compiles.
    """
    # A program that Python is built into could start itself once more.
    is_python = Path(sys.executable or "").stem.lower().startswith("python")
    if not is_python or threads() < 2 or compile_cache.write("begun", b"") is None:
        return None
    code = f"import {__name__} as module; module._end_with_parent(); module.{function}()"
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


def _compile_after(graph: CutCellGraph) -> None:
    """Compile what a binding needs once it has its graph."""
    methods = ANIMATION, ANIMATION.with_options(falloff="paper")
    for method in methods:  # which measure from different numbers of joints
        within = ANIMATION.reach_needed
        distances = bone_distances(graph, chain(), method=method, leaf="fit", within=within)
    for method in methods:
        skinning_weights(distances, method=method)
    every = np.ones(distances.joint.shape[::-1], bool)
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
