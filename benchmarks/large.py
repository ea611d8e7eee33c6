"""How long large meshes take, stage by stage, and how far their weights are from exact ones.

python -m benchmarks.large [--rig RIG] [--times 0 1 2 3] [--exact 2] [--markdown OUT]

The rig's triangles are quartered again and again. Many vertices are solved for by multigrid
(`cutcell/weights/rig_falloff/multigrid.py`); the exact weights are those by factors of the whole
matrix, from the same distances.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter, process_time
from unittest.mock import patch

import numpy as np
import trimesh

import cutcell
from cutcell.geometry.weld import weld
from cutcell.weights.rig_falloff import diffusion
from cutcell.weights.rig_falloff.surface_operators import SurfaceOperators
from cutcell_lab.benchmarks.rigs import ROOT
from cutcell_lab.benchmarks.tables import Table, publish, seconds

from .report import circumstances

STAGES = ("graph", "distances", "weights")


def quartered(rig: cutcell.Rig, times: int) -> cutcell.Rig:
    """Weld a rig's mesh and divide each triangle into four, repeatedly."""
    vertices, index = weld(rig.mesh.vertices)
    faces = index[rig.mesh.faces]
    for _ in range(times):
        vertices, faces = trimesh.remesh.subdivide(vertices, faces)
    return cutcell.Rig(cutcell.TriangleMesh(vertices, faces), rig.skeleton)


def exact_weights(binding: cutcell.Binding) -> np.ndarray:
    """Compute the weights, before they are pruned, by factors of the whole matrix."""
    with patch.object(diffusion, "MANY", np.inf):
        return unpruned(binding, SurfaceOperators.of(binding.graph))


def unpruned(binding: cutcell.Binding, surface: SurfaceOperators) -> np.ndarray:
    """Compute the weights of all joints that distances were measured from."""
    return cutcell.skinning_weights(binding.distances, surface=surface, threshold=0)


def row(rig: cutcell.Rig, is_compared: bool) -> list[str]:
    """Bind a rig; return its size, times, and the difference from exact weights if compared."""
    begin, begin_processor = perf_counter(), process_time()
    binding = cutcell.bind(rig)
    took, by_processor = perf_counter() - begin, process_time() - begin_processor
    cells = [f"{len(rig.mesh.faces):,}", *(seconds(binding.seconds[name]) for name in STAGES)]
    cells += [seconds(took), seconds(by_processor)]
    if not is_compared:
        return [*cells, "-", "-"]
    begin = perf_counter()
    exact = exact_weights(binding)
    took = perf_counter() - begin
    outcome = unpruned(binding, SurfaceOperators.of(binding.graph))
    return [*cells, seconds(took), f"{np.abs(outcome - exact).max():.1e}"]


def tables(options: argparse.Namespace) -> list[Table]:
    """Measure one rig at several sizes."""
    rig = cutcell.load(options.rig)
    cutcell.bind(quartered(rig, min(2, max(options.times))))  # load what it calls
    table = Table(
        "Large meshes",
        ["faces", *STAGES, "all", "processor time", "exact weights", "largest difference"],
        f"`bind`, warm, R=64, {options.rig.stem}, its triangles quartered again and again. Weights "
        "before pruning, of each vertex and joint, beside those by factors of the whole matrix. "
        + circumstances(),
    )
    for times in options.times:
        table.add(*row(quartered(rig, times), times <= options.exact))
    return [table]


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.large", description=__doc__)
    parser.add_argument("--rig", type=Path, default=ROOT / "assets" / "biped.glb")
    parser.add_argument(
        "--times", type=int, nargs="+", default=[0, 1, 2, 3], help="how often to quarter"
    )
    parser.add_argument(
        "--exact", type=int, default=2, help="compare with exact weights up to so many times"
    )
    parser.add_argument("--markdown", type=Path, metavar="OUT")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table, and write it too if a file is named."""
    options = arguments(argv)
    publish(tables(options), options.markdown)


if __name__ == "__main__":
    main()
