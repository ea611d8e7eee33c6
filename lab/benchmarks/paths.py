"""How far drawn paths leave the body: random paths on every rig, with each kind of connectivity.

    python -m cutcell_lab.benchmarks.paths [RIG ...] [--paths 1000] [--out docs/performance.md]

Every path is sampled ten times a lattice cell. A sample whose winding number is below tau is
outside; how far, is measured to the nearest point of the surface or of an edge inside.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import igl
import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.geodesics import PIECES, BoneDistances, TracedPath, trace_path
from cutcell.graph.winding.exact import winding_numbers_of

from .document import fill
from .rigs import rig_paths
from .tables import Table

SAMPLES = 10
"""Samples of a path for each lattice cell of its length."""
CONNECTIVITIES = (6, 26, "any")
OUTSIDE = PIECES.index("outside")


@dataclass(frozen=True)
class PathErrors:
    """Measures of one rig: the largest distances outside, in lattice cells, and others."""

    inside: float
    outside_count: int
    to_bone: float
    longer: float
    milliseconds: float


def outside_by(distances: BoneDistances, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Measure how far points (q, 3) are outside of the body, in lattice cells; 0 inside."""
    graph = distances.graph
    away = np.zeros(len(points))
    number = winding_numbers_of(graph.mesh, points)
    out = np.flatnonzero(number < graph.winding_threshold)
    if len(out):
        surface = graph.nodes[: graph.first_point], graph.faces.astype(np.int64)
        squared = igl.point_mesh_squared_distance(points[out], *surface)[0]
        # Where a mesh is open, the body ends in the air: there its edges inside tell where.
        inner = graph.edges[graph.edge_kind == 1]
        ends = np.hstack([inner, inner[:, 1:]]).astype(np.int64)  # as triangles without area
        to_edges = igl.point_mesh_squared_distance(points[out], graph.nodes, ends)[0]
        away[out] = np.sqrt(np.minimum(squared, to_edges)) * graph.lattice.resolution
    return away


def samples_of(path: TracedPath, resolution: int) -> tuple[NDArray, NDArray]:
    """Return points along a path, and the kind of the piece that each lies on."""
    counts = np.ceil(path.lengths * resolution * SAMPLES).astype(int) + 1
    points = [
        a + np.linspace(0, 1, n)[:, None] * (b - a)
        for a, b, n in zip(path.points[:-1], path.points[1:], counts, strict=True)
    ]
    return np.concatenate(points), np.repeat(path.kinds, counts)


def measure(rig: cutcell.Rig, connectivity: int | str, paths: int, resolution: int) -> PathErrors:
    """Trace random paths of one rig and measure them."""
    graph = cutcell.build_graph(rig.mesh, resolution, connectivity=connectivity)
    distances = cutcell.bone_distances(graph, rig.skeleton, leaf="fit")
    rng = np.random.default_rng(17)
    joints = np.unique(distances.bones.joint)
    share = np.bincount(rng.integers(len(joints), size=paths), minlength=len(joints))
    points, kinds, longer, spent, outside_count = [], [], 0.0, 0.0, 0
    for joint, count in zip(joints.tolist(), share.tolist(), strict=True):
        field = distances.field(joint)
        reached = np.flatnonzero(np.isfinite(field[graph.vertex_node]))
        for vertex in rng.choice(reached, count if len(reached) else 0).tolist():
            begin = time.perf_counter()
            path = trace_path(distances, joint, vertex, field)
            spent += time.perf_counter() - begin
            expected = field[graph.vertex_node[vertex]]
            longer = max(longer, path.length / max(expected, 1e-9) - 1)
            outside_count += bool((path.kinds == OUTSIDE).any())
            samples = samples_of(path, resolution)
            points.append(samples[0])
            kinds.append(samples[1])
    away, is_outside = (
        outside_by(distances, np.concatenate(points)),
        np.concatenate(kinds) == OUTSIDE,
    )
    most = away[~is_outside].max(initial=0), outside_count, away[is_outside].max(initial=0)
    return PathErrors(*most, longer, 1000 * spent / paths)


def path_table(
    rigs: Sequence[cutcell.Rig],
    paths: int,
    resolution: int,
    connectivities: Sequence[int | str] = CONNECTIVITIES,
) -> Table:
    """Measure all rigs, telling of each."""
    columns = ["rig", "connectivity", "outside, cells", "paths to a bone outside", "bone, cells"]
    columns += ["longer than the field", "ms a path"]
    table = Table(
        "Paths stay inside",
        columns,
        f"{paths:,} random paths on each rig, R = {resolution}. `outside`: the largest distance of "
        "any piece from the body, without those marked as outside: paths to a bone that is not in "
        "the body. How many paths end in one, and how far out these run, is in the next columns.",
    )
    for rig in rigs:
        for connectivity in connectivities:
            rows = measure(rig, connectivity, paths, resolution)
            cells = rig.name, connectivity, f"{rows.inside:.2f}", rows.outside_count
            more = f"{rows.to_bone:.2f}", f"{rows.longer:.1%}", f"{rows.milliseconds:.1f}"
            table.add(*cells, *more)
            print(*cells, *more, flush=True)
    most = max(float(row[2]) for row in table.rows)
    table.add("**largest**", "", f"**{most:.2f}**", "", "", "", "")
    return table


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--paths", type=int, default=1000)
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--connectivity", choices=[str(c) for c in CONNECTIVITIES])
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    rigs = [cutcell.load(path) for path in rig_paths(options.rigs)]
    chosen = [c for c in CONNECTIVITIES if options.connectivity in (None, str(c))]
    text = path_table(rigs, options.paths, options.resolution, chosen).markdown()
    print(text)
    if options.out:
        fill(options.out, {"paths": text})


if __name__ == "__main__":
    main()
