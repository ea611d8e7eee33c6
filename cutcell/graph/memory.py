"""Refuse graphs that would not fit in memory, before memory is taken for them."""

from __future__ import annotations

from collections.abc import Callable

from ..errors import TooLargeError
from ..runtime.memory import SHARE, available_memory, gigabytes
from .rays import expected_hits
from .surface import Surface

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


def check_hits(surface: Surface) -> None:
    """Refuse rays whose hits would take more memory than is free."""
    hits = expected_hits(surface.mesh.points, surface.mesh.faces, surface.resolution)
    _require(lambda scale: BYTES_PER_HIT * hits * scale**2, surface.resolution)


def check_nodes(
    vertices: int, points: int, surface: int, resolution: int, connectivity: int | str
) -> None:
    """Refuse a graph of this size if it needs more memory than is free."""
    # Points fill the volume, surface nodes the surface, and vertices stay as they are.
    _require(
        lambda scale: needed_memory(vertices, points * scale**3, surface * scale**2, connectivity),
        resolution,
    )


def _require(needed: Callable[[float], float], resolution: int) -> None:
    """Refuse what needs more memory than is free; `needed` takes a factor of the resolution."""
    free = available_memory() * SHARE
    if needed(1) <= free:
        return
    fits = next((r for r in range(resolution, 1, -1) if needed(r / resolution) <= free), None)
    advice = f"a resolution of {fits} would fit" if fits else "no resolution would fit"
    raise TooLargeError(
        f"resolution {resolution} needs about {gigabytes(needed(1))}, but only "
        f"{gigabytes(free)} of memory are free for it; {advice}"
    )


def needed_memory(vertices: float, points: float, surface: float, connectivity: int | str) -> float:
    """Return the peak memory of a graph of this size and its distances, in bytes."""
    bytes_ = (vertices + points + surface) * BYTES_PER_NODE[connectivity] + FIXED_BYTES
    if connectivity != "any":
        return bytes_
    shallow = min(points, SHALLOW * surface)
    labelled = vertices + surface + shallow + (points - shallow) / BLOCK_POINTS
    return bytes_ + labelled * BYTES_PER_LABELLED
