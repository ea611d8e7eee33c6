"""Refuse graphs that would not fit in memory, before they are built."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..runtime.memory import SHARE, available_memory, gigabytes
from ..runtime.progress import Tell
from .interior import interior_points
from .rays import cast_all_rays, expected_hits
from .winding import inside_intervals
from .winding.boundary import Boundary
from .winding.segments import NONE

BYTES_PER_NODE = {6: 345, 26: 950, "any": 150}
"""Peak of a graph and its distances, by connectivity; measured by benchmarks/memory.py."""
BYTES_PER_LABELLED = 210
"""With "any", in addition, for each node that is not contracted (`contraction.py`)."""
BLOCK_POINTS = 8
"""Lattice points deep inside that have one representative."""
SHALLOW = 1.5
"""Lattice points outside such blocks for each surface node, at most; 1.2 was measured."""
FIXED_BYTES = 64 << 20
"""Memory that does not grow with the nodes: the mesh, its holes and its weights, at most."""
BYTES_PER_HIT = 80
"""Peak of casting rays at the mesh and at the caps of its holes, whatever is inside."""
COARSE = 64
"""Resolution at which nodes are counted to estimate those of a far finer lattice."""
FAR_FINER = 2
"""Times that resolution: below, the graph is built in the time that the estimate takes."""
CERTAIN = 1.1
"""An estimate must exceed the free memory by this factor to be relied on."""


def check_estimate(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    boundary: Boundary,
    resolution: int,
    winding_threshold: float,
    connectivity: int | str,
    tell: Tell = lambda done: None,
) -> None:
    """Refuse a graph that would surely take more memory than is free, before rays are cast."""
    hits = expected_hits(vertices, faces, resolution)
    _refuse_over(lambda scale: BYTES_PER_HIT * hits * scale**2, resolution, CERTAIN)
    sides = np.ptp(np.clip(vertices, 0, 1), axis=0)  # vertices without faces may lie anywhere
    points = resolution**3 * float(sides.prod())
    most = needed_memory(len(vertices), points, hits, connectivity)
    if resolution < FAR_FINER * COARSE or most <= available_memory() * SHARE:
        return
    coarse = cast_all_rays(vertices, faces, COARSE)
    inside = inside_intervals(vertices, faces, coarse, boundary, COARSE, winding_threshold, tell)
    ends = sum(
        np.count_nonzero(along.low != NONE) + np.count_nonzero(along.high != NONE)
        for along in inside
    )
    finer = resolution / COARSE
    nodes = len(vertices), len(interior_points(inside, COARSE)) * finer**3, ends * finer**2
    check_memory(*nodes, resolution, connectivity, CERTAIN)


def check_memory(
    vertices: float,
    points: float,
    surface: float,
    resolution: int,
    connectivity: int | str,
    certain: float = 1,
) -> None:
    """Refuse a graph that would take more memory than is free."""

    def needed(scale: float) -> float:
        # Points fill the volume, surface nodes the surface, and vertices stay as they are.
        return needed_memory(vertices, points * scale**3, surface * scale**2, connectivity)

    _refuse_over(needed, resolution, certain)


def _refuse_over(needed: Callable[[float], float], resolution: int, certain: float) -> None:
    """Refuse what needs more memory than is free; `needed` takes a factor of the resolution."""
    free = available_memory() * SHARE
    if needed(1) <= certain * free:
        return
    fits = next((r for r in range(resolution, 1, -1) if needed(r / resolution) <= free), None)
    advice = f"a resolution of {fits} would fit" if fits else "no resolution would fit"
    raise ParameterError(
        f"resolution {resolution} needs about {gigabytes(needed(1))}, but only "
        f"{gigabytes(free)} of memory are free for it; {advice}"
    )


def needed_memory(vertices: float, points: float, surface: float, connectivity: int | str) -> float:
    """Return how many bytes a graph of so many nodes and its distances take at their peak."""
    bytes_ = (vertices + points + surface) * BYTES_PER_NODE[connectivity] + FIXED_BYTES
    if connectivity != "any":
        return bytes_
    shallow = min(points, SHALLOW * surface)
    labelled = vertices + surface + shallow + (points - shallow) / BLOCK_POINTS
    return bytes_ + labelled * BYTES_PER_LABELLED
