"""All kernels of a binding at once, so that no character waits for one of them."""

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path

import numba
import numpy as np
from llvmlite import binding
from numba.core.dispatcher import Dispatcher

from ..geodesics import bone_distances
from ..graph import CutCellGraph, build_graph
from ..threads import threads
from .prune import _prune
from .specimens import block_graph, chain, tube
from .weights import DEFAULT_LEAF, joints_needed, reach_needed, skinning_weights

PACKAGE = Path(__file__).resolve().parents[1]
SOURCES = (
    "compiled.py",
    "sorting.py",
    "unions.py",
    "graph/*.py",
    "geodesics/*.py",
    "skinning/*.py",
)
"""Where the kernels of a binding stand, and what they are compiled by."""

_known = False


def load_kernels() -> None:
    """Bind a small tube with holes, and a stud, in every way that has kernels of its own.

    Kernels are compiled once on a machine (about a minute, in two processes) and kept on disk;
    from there a process loads them in about a second. All are thrown away once any source has
    changed: numba itself sees no change in another file than a kernel's own.
    """
    compiled = kernels_are_compiled()
    if not compiled:
        forget(_kernels())
    with nullcontext() if compiled else _beside("compile_after_graph"):
        graphs = [build_graph(tube(), 8, connectivity=kind) for kind in ("any", 26)]
    for graph in graphs:
        _compile_after(graph)
    _write_stamp()


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
    if threads() < 2 or not Path(sys.executable or "").stem.lower().startswith("python"):
        yield  # a program that Python is built into could start itself once more
        return
    command = [sys.executable, "-c", f"from {__name__} import {function}; {function}()"]
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


def kernels_are_compiled() -> bool:
    """Tell whether this machine has compiled the kernels as they now are, in any process."""
    global _known
    if not _known:
        with suppress(OSError):
            _known = _stamp_path().read_text(encoding="utf-8") == _stamp()
    return _known


def forget(kernels: Sequence[Dispatcher]) -> None:
    """Throw away what numba has kept of kernels on disk, unless this process uses it already."""
    if not any(kernel.signatures for kernel in kernels):
        for kernel in kernels:
            with suppress(OSError):
                kernel._cache.flush()  # type: ignore[attr-defined]


def _kernels() -> list[Dispatcher]:
    """List the kernels of the package's modules that have been imported."""
    modules = [sys.modules[name] for name in sys.modules if name.startswith("cutcell.")]
    found = (kernel for module in modules for kernel in vars(module).values())
    return [kernel for kernel in found if isinstance(kernel, Dispatcher)]


def _write_stamp() -> None:
    """Note beside numba's cache what it was made from."""
    path = _stamp_path()
    with suppress(OSError):  # without it the next process announces a compile that is quick
        unready = path.with_suffix(f".{os.getpid()}")
        unready.write_text(_stamp(), encoding="utf-8")
        unready.replace(path)


def _stamp_path() -> Path:
    return Path(str(_prune.stats.cache_path)) / "kernels.stamp"


def _stamp() -> str:
    """Return what numba looks at before it takes a kernel from its cache."""
    made_for = f"{sys.implementation.cache_tag} {numba.__version__} {binding.get_host_cpu_name()}"
    files = sorted(path for pattern in SOURCES for path in PACKAGE.glob(pattern))
    states = [(path.relative_to(PACKAGE).as_posix(), path.stat()) for path in files]
    lines = [f"{name} {state.st_mtime_ns} {state.st_size}" for name, state in states]
    return "\n".join([made_for, *lines])
