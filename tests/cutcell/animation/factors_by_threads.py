"""Print by how many kB a process grows in which threads factorise the same matrix."""

import re
from pathlib import Path
from threading import Thread

import numpy as np

from cutcell.animation.falloff.diffusion import Diffusion
from cutcell.animation.falloff.surface_operators import SurfaceOperators
from tests.cutcell.animation.test_large_meshes import DEPTH, grid

SIDE = 120


def resident() -> int:
    """Return how many kB the process has in memory."""
    status = Path("/proc/self/status").read_text()
    return int(re.findall(r"VmRSS:\s+(\d+) kB", status)[0])


def factorise(surface: SurfaceOperators) -> None:
    """Let a thread make a `Diffusion`, and drop it in this one."""
    results = []
    depth = np.full(SIDE**2, DEPTH)
    thread = Thread(target=lambda: results.append(Diffusion.over(surface, depth, 64)))
    thread.start()
    thread.join()


def main() -> None:
    """Factorise 3 and then 20 times."""
    points, faces = grid(SIDE)
    surface = SurfaceOperators.over(points, faces.astype(np.int32))
    for _ in range(3):
        factorise(surface)
    before = resident()
    for _ in range(20):
        factorise(surface)
    print(resident() - before)


if __name__ == "__main__":
    main()
