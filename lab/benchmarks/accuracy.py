"""How far distances are from true ones, on shapes whose true ones are known.

python -m cutcell_lab.benchmarks.accuracy [--resolutions 16 32 ...] [--shapes ...] [--markdown OUT]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from cutcell import ParameterError, Skeleton
from cutcell.geodesics import bone_distances
from cutcell.graph import build_graph

from .tables import Table, percent, publish, seconds
from .truth import SHAPES, Shape

CONNECTIVITIES = (6, 26, "any")
EXACT = 1e-6
"""Smaller errors are rounding."""

NEAR = 2
"""Cells around a source that are left out: there a relative error says nothing."""


@dataclass(frozen=True)
class Errors:
    """Relative errors of one shape, and the seconds for graph and distances."""

    mean: float
    largest: float
    seconds: float
    unreached: int


def measure(shape: Shape, resolution: int, connectivity: int | str, repeats: int = 1) -> Errors:
    """Compare the distances of a shape with the true ones.

    Each source is a separate joint without children: a bone that is a point.

    Raises
    ------
    ParameterError
        There is no such connectivity.
    """
    count = len(shape.sources)
    skeleton = Skeleton(shape.sources, np.full(count, -1))
    spent = []
    for _ in range(repeats):
        begin = perf_counter()
        graph = build_graph(shape.mesh, resolution, connectivity=connectivity)  # type: ignore[arg-type]
        distances = bone_distances(graph, skeleton, method="paper")
        spent.append(perf_counter() - begin)
    measured = distances.joint[:, shape.targets] * graph.lattice.size
    cell = graph.lattice.size / resolution
    far = shape.distance >= NEAR * cell
    unreached = int((distances.fallback[shape.targets] != 0).sum())
    error = np.abs(measured[far] / shape.distance[far] - 1)
    return Errors(float(error.mean()), float(error.max()), float(np.median(spent)), unreached)


def order(resolutions: Sequence[int], errors: Sequence[float]) -> str:
    """Fit p in error ~ R^-p by least squares, over errors above rounding."""
    is_inexact = np.array(errors) > EXACT
    if not is_inexact[-1]:
        return "exact"
    if is_inexact.sum() < 2:
        return "-"
    scale, error = np.array(resolutions)[is_inexact], np.array(errors)[is_inexact]
    return f"{-np.polyfit(np.log(scale), np.log(error), 1)[0]:.2f}"


def tables(options: argparse.Namespace) -> list[Table]:
    """Measure all shapes, resolutions and connectivities."""
    resolutions = options.resolutions
    accuracy = Table(
        "Accuracy of distances",
        ["shape", "connectivity", *(f"R={r}" for r in resolutions), "order in R"],
        "Mean (largest) relative error of the distance from points inside to the vertices of "
        f"the mesh. Vertices nearer than {NEAR} lattice cells to the point are left out. The "
        "order p is fitted to the means: error ~ R^-p. Torus and spiral tube are compared "
        "with a convex solution through cross-sections, right to 1e-4.",
    )
    cost = Table(
        "Cost of accuracy",
        ["shape", "connectivity", *(f"R={r}" for r in resolutions)],
        "Seconds for graph and distances from those points, and how many times as long as "
        "connectivity 6 takes.",
    )
    everything: dict[int | str, list[list[Errors]]] = {}
    missing = set()
    for name in options.shapes:
        shape = SHAPES[name]()
        base: list[Errors] = []
        for connectivity in CONNECTIVITIES:
            row = []
            try:
                measure(shape, 8, connectivity)  # warm
                row = [measure(shape, r, connectivity, options.repeats) for r in resolutions]
            except ParameterError:
                missing.add(connectivity)
                continue
            base = base or row
            everything.setdefault(connectivity, []).append(row)
            _add(accuracy, cost, name, connectivity, row, base, resolutions)
            print(f"accuracy: {name}, {connectivity}", file=sys.stderr, flush=True)
    for connectivity, rows in everything.items():
        means = [np.mean([row[k].mean for row in rows]) for k in range(len(resolutions))]
        worst = [np.max([row[k].largest for row in rows]) for k in range(len(resolutions))]
        cells = [f"{percent(m)} ({percent(w)})" for m, w in zip(means, worst, strict=True)]
        accuracy.add("**all**", connectivity, *cells, order(resolutions, means))
    for connectivity in sorted(missing, key=str):
        sentence = f" Connectivity {connectivity!r} is not there yet: skipped."
        accuracy.note += sentence
        print(sentence.strip(), file=sys.stderr)
    return [accuracy, cost]


def _add(accuracy, cost, name, connectivity, row, base, resolutions) -> None:
    cells = [
        f"{percent(e.mean)} ({percent(e.largest)})"
        + (f", {e.unreached} lost" if e.unreached else "")
        for e in row
    ]
    accuracy.add(name, connectivity, *cells, order(resolutions, [e.mean for e in row]))
    times = [
        f"{seconds(e.seconds)} ({e.seconds / b.seconds:.1f}x)"
        for e, b in zip(row, base, strict=True)
    ]
    cost.add(name, connectivity, *times)


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.accuracy", description=__doc__
    )
    parser.add_argument("--resolutions", type=int, nargs="+", default=[16, 32, 64, 128])
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--markdown", type=Path, metavar="OUT")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the tables, and write them too if a file is named."""
    options = arguments(argv)
    publish(tables(options), options.markdown)


if __name__ == "__main__":
    main()
