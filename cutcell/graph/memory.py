"""Refuse graphs that would not fit in memory, before they are built."""

from __future__ import annotations

import os
import re
from pathlib import Path

from ..errors import ParameterError

BYTES_PER_NODE = {6: 345, 26: 950, "any": 375}
"""Peak of a graph and its distances, by connectivity; measured by benchmarks/memory.py."""
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
        nodes = vertices + crossings * scale**2 + points * scale**3
        return needed_memory(nodes, connectivity)

    free = available_memory() * SHARE
    if needed(1) <= free:
        return
    fits = next((r for r in range(resolution, 1, -1) if needed(r / resolution) <= free), None)
    advice = f"a resolution of {fits} would fit" if fits else "no resolution would fit"
    raise ParameterError(
        f"resolution {resolution} needs about {needed(1) / 1e9:.2g} GB, but only "
        f"{free / 1e9:.2g} GB of memory are free for it; {advice}"
    )


def needed_memory(nodes: float, connectivity: int | str) -> float:
    """Return how many bytes a graph of so many nodes and its distances take at their peak."""
    return nodes * BYTES_PER_NODE[connectivity] + BYTES_BESIDES


def available_memory() -> int:
    """Return how many bytes new data may take without swapping."""
    try:
        found = re.search(r"MemAvailable:\s+(\d+) kB", Path("/proc/meminfo").read_text())
    except OSError:
        found = None
    if found:
        return int(found[1]) * 1024
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
