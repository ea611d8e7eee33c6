"""All kernels of a binding at once, so that no character waits for one of them."""

import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import numpy as np

from .. import kernel_cache
from ..geodesics import bone_distances
from ..graph import CutCellGraph, build_graph
from ..threads import threads
from .specimens import block_graph, chain, tube
from .weights import DEFAULT_LEAF, joints_needed, reach_needed, skinning_weights

_loaded = False


def load_kernels() -> None:
    """Bind a small tube with holes, and a stud, in every way that has kernels of its own.

    Kernels are compiled once on a machine (about a minute, in two processes) and kept on disk, see
    `kernel_cache`; from there a process loads them in about a second. Where they cannot be kept,
    each process compiles them in memory, and one sentence is logged.
    """
    global _loaded
    is_complete = kernel_cache.is_complete()
    with nullcontext() if is_complete else _beside("compile_after_graph"):
        graphs = [build_graph(tube(), 8, connectivity=kind) for kind in ("any", 26)]
    for graph in graphs:
        _compile_after(graph)
    _loaded = True
    if not is_complete:
        kernel_cache.mark_complete()
        if kernel_cache.refusals:
            logging.getLogger("cutcell").warning(
                "the compiled kernels cannot be kept (%s), so that each start takes a minute or "
                "two; set NUMBA_CACHE_DIR to a folder that can be written to",
                kernel_cache.refusals[-1],
            )


def compile_after_graph() -> None:
    """Compile what a binding needs once it has its graph, which takes about as long as that."""
    _compile_after(block_graph())


def _compile_after(graph: CutCellGraph) -> None:
    for nearest in {joints_needed("paper", 4), joints_needed("rig", 4)}:
        distances = bone_distances(
            graph,
            chain(),
            leaf=DEFAULT_LEAF["rig"],
            nearest_joints=nearest,
            within=reach_needed("rig"),
        )
    for falloff in ("rig", "paper"):
        skinning_weights(distances, falloff=falloff, max_influences=4)
    every = np.ones(distances.joint.shape[::-1], bool)
    skinning_weights(distances, falloff="paper", max_influences=4, allowed=every)


@contextmanager
def _beside(function: str) -> Iterator[None]:
    """Let another process call a function of this module meanwhile; wait for it at the end.

    Only one thread of a process can compile. What that process fails to do is left to this one.
    """
    if not _can_be_helped():
        yield
        return
    command = [sys.executable, "-c", f"from cutcell.skinning import kernels; kernels.{function}()"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    nothing = subprocess.DEVNULL
    try:
        process = subprocess.Popen(
            command, env=environment, stdin=nothing, stdout=nothing, stderr=nothing
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
    """Tell whether another process can start, and hand over what it compiles."""
    # A program that Python is built into could start itself once more.
    is_python = Path(sys.executable or "").stem.lower().startswith("python")
    return is_python and threads() > 1 and kernel_cache.write("begun", b"") is not None


def kernels_are_compiled() -> bool:
    """Tell whether the kernels, as they now are, are in memory or kept on this machine."""
    return _loaded or kernel_cache.is_complete()
