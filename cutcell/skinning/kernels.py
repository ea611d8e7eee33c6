"""All kernels of a binding at once, so that no character waits for one of them."""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numba
import numpy as np
from llvmlite import binding
from numba.core.dispatcher import Dispatcher

from ..geodesics import bone_distances
from ..graph import build_graph
from ..rig import Skeleton, TriangleMesh
from .prune import _prune
from .weights import DEFAULT_LEAF, joints_needed, reach_needed, skinning_weights

AROUND = 16
"""Vertices around the tube: its open ends are holes too wide for a few triangles."""
MISSING = 5, 25, 45, 65, 85
"""Faces of the tube that leave small holes: enough holes for a tree of them."""
STUD = np.array([[0.3, 0, 0.5], [0.35, 0, 0.5], [0.3, 0.05, 0.5], [0.3, 0, 0.55]])
"""Beside the tube: pieces of a mesh are looked at where there are several."""
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

    Kernels are compiled once on a machine (about a minute) and kept on disk; from there a
    process loads them in about a second. All are thrown away once any source has changed: numba
    itself sees no change in another file than a kernel's own.
    """
    if not kernels_are_compiled():
        forget(_kernels())
    # More joints than a vertex has distances of. The last is so far away that its labels outlast
    # the queue's buckets.
    joints = np.zeros((8, 3))
    joints[:, 2] = np.linspace(0.1, 0.9, 8)
    joints[-1] = 3
    skeleton = Skeleton(joints, np.array([*range(-1, 6), -1]))
    for connectivity in ("any", 26):
        graph = build_graph(_tube(), 8, connectivity=connectivity)
        for nearest in {joints_needed("paper", 4), joints_needed("rig", 4)}:
            distances = bone_distances(
                graph,
                skeleton,
                leaf=DEFAULT_LEAF["rig"],
                nearest_joints=nearest,
                within=reach_needed("rig"),
            )
        for falloff in ("rig", "paper"):
            skinning_weights(distances, falloff=falloff, max_influences=4)
        every = np.ones(distances.joint.shape[::-1], bool)
        skinning_weights(distances, falloff="paper", max_influences=4, allowed=every)

    _write_stamp()


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


def _tube() -> TriangleMesh:
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    heights = np.linspace(0, 1, 5)
    rings = [np.stack([np.cos(turn) / 5, np.sin(turn) / 5, np.full(AROUND, z)], 1) for z in heights]
    here = np.arange((len(heights) - 1) * AROUND)
    beside = here // AROUND * AROUND + (here + 1) % AROUND
    faces = [[here, beside, beside + AROUND], [here, beside + AROUND, here + AROUND]]
    whole = np.concatenate([np.stack(face, axis=1) for face in faces])
    tube = np.delete(whole, MISSING, axis=0)
    stud = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]) + len(rings) * AROUND
    vertices = np.concatenate([*rings, STUD])
    return TriangleMesh(vertices, np.concatenate([tube, stud]))
