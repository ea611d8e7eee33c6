"""Refuse graphs that would not fit in memory, before they are built."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path

from ..errors import ParameterError
from .blocks import BLOCK_POINTS

BYTES_PER_NODE = {6: 345, 26: 950, "any": 150}
"""Peak of a graph and its distances, by connectivity; measured by benchmarks/memory.py."""
BYTES_PER_LABELLED = 210
"""More, with "any", for each node that is not passed over (`contracted.py`)."""
SHALLOW = 1.5
"""Lattice points in no block, a crossing, at most; measured were 1.2."""
BYTES_BESIDES = 64 << 20
"""What does not grow with the nodes: the mesh, its holes and its weights, at most."""
SHARE = 0.8
"""Of the free memory that one graph may take."""


def check_memory(
    vertices: int, points: int, crossings: int, resolution: int, connectivity: int | str
) -> None:
    """Refuse a graph that would take more memory than is free.

    Parameters
    ----------
    vertices, points, crossings : int
        How many nodes of each kind the graph will have.
    resolution : int
    connectivity : {6, 26, "any"}

    Raises
    ------
    ParameterError
        It would not fit; the sentence says which resolution would.
    """

    def needed(scale: float) -> float:
        # Points fill the volume, crossings the surface, and vertices stay as they are.
        return needed_memory(vertices, points * scale**3, crossings * scale**2, connectivity)

    free = available_memory(needed(1) / SHARE) * SHARE
    if needed(1) <= free:
        return
    fits = next((r for r in range(resolution, 1, -1) if needed(r / resolution) <= free), None)
    advice = f"a resolution of {fits} would fit" if fits else "no resolution would fit"
    raise ParameterError(
        f"resolution {resolution} needs about {needed(1) / 1e9:.2g} GB, but only "
        f"{free / 1e9:.2g} GB of memory are free for it; {advice}"
    )


def needed_memory(
    vertices: float, points: float, crossings: float, connectivity: int | str
) -> float:
    """Return how many bytes a graph of so many nodes and its distances take at their peak."""
    bytes_ = (vertices + points + crossings) * BYTES_PER_NODE[connectivity] + BYTES_BESIDES
    if connectivity != "any":
        return bytes_
    shallow = min(points, SHALLOW * crossings)
    labelled = vertices + crossings + shallow + (points - shallow) / BLOCK_POINTS
    return bytes_ + labelled * BYTES_PER_LABELLED


def available_memory(enough: float = math.inf) -> int:
    """Return how many bytes new data may take without swapping, or no less than is enough."""
    free = _pages("SC_AVPHYS_PAGES")
    if free >= enough:
        return free  # how much the system could clear takes far longer to find out
    try:
        found = re.search(r"MemAvailable:\s+(\d+) kB", Path("/proc/meminfo").read_text())
    except OSError:
        found = None
    if found:
        return int(found[1]) * 1024
    return _pages("SC_PHYS_PAGES") // 2


def _pages(name: str) -> int:
    """Return the size of some pages of memory, 0 where the system does not tell."""
    if name not in os.sysconf_names:
        return 0
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf(name)
