"""How long large meshes take, stage by stage.

python -m benchmarks.large [--rig RIG] [--times 0 1 2 3] [--markdown OUT]

The rig's triangles are quartered again and again. `diagnose` checks the rig with its new weights.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

import trimesh

import cutcell
from cutcell_lab.benchmarks.rigs import ROOT
from cutcell_lab.benchmarks.tables import Table, publish, seconds

from .growth import peak_memory, slope
from .report import circumstances

STAGES = ("graph", "distances", "weights")


def quartered(rig: cutcell.Rig, times: int) -> cutcell.Rig:
    """Weld a rig's mesh and divide each triangle into four, repeatedly."""
    vertices, faces = rig.mesh.cube.to_file(rig.mesh.welded.points), rig.mesh.welded.faces
    for _ in range(times):
        vertices, faces = trimesh.remesh.subdivide(vertices, faces)
    return cutcell.Rig(cutcell.TriangleMesh(vertices, faces), rig.skeleton)


@dataclass
class Measured:
    """One size: seconds by stage, and processor seconds of the weights."""

    faces: int
    seconds: dict[str, float]
    processor: float
    peak: float
    diagnosis: float

    def row(self) -> list[str]:
        """Return the cells of a table."""
        times = [*(self.seconds[name] for name in STAGES), self.processor, self.diagnosis]
        return [f"{self.faces:,}", *map(seconds, times), f"{self.peak:,.0f} MB"]


def measure(rig: cutcell.Rig) -> Measured:
    """Bind and diagnose a rig."""
    binding = cutcell.bind(rig)
    begin = process_time()
    cutcell.skinning_weights(binding.distances)
    processor, peak = process_time() - begin, peak_memory()
    begin = perf_counter()
    cutcell.diagnose(rig.with_weights(binding.weights))
    diagnosis = perf_counter() - begin
    sizes = len(rig.mesh.faces), binding.seconds
    return Measured(*sizes, processor, peak, diagnosis)


def tables(options: argparse.Namespace) -> list[Table]:
    """Measure one rig at several sizes."""
    rig = cutcell.load(options.rig)
    small = quartered(rig, min(2, max(options.times)))
    cutcell.diagnose(small.with_weights(cutcell.bind(small).weights))  # load what they call
    table = Table(
        "Large meshes",
        ["faces", *STAGES, "weights, processor time", "diagnose", "peak memory of bind"],
        f"`bind`, warm, R=64, {options.rig.stem}, its triangles quartered again and again. "
        "Slope s: value ~ faces^s over the three largest. " + circumstances(),
    )  # fmt: skip
    sizes = [measure(quartered(rig, times)) for times in options.times]
    for size in sizes:
        table.add(*size.row())
    faces = [size.faces for size in sizes]
    slopes = [slope(faces, [size.seconds[name] for size in sizes]) for name in STAGES]
    slopes += [slope(faces, [getattr(size, name) for size in sizes])
               for name in ("processor", "diagnosis", "peak")]  # fmt: skip
    table.add("**slope**", *(f"{value:.2f}" for value in slopes))
    return [table]


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.large", description=__doc__)
    parser.add_argument("--rig", type=Path, default=ROOT / "assets" / "biped.glb")
    parser.add_argument(
        "--times", type=int, nargs="+", default=[0, 1, 2, 3], help="how often to quarter"
    )
    parser.add_argument("--markdown", type=Path, metavar="OUT")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table, and write it too if a file is named."""
    options = arguments(argv)
    publish(tables(options), options.markdown)


if __name__ == "__main__":
    main()
