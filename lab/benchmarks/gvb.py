"""Accuracy, time and graph size beside geodesic voxel binding, over R (the paper's Figure "gvb").

    python -m cutcell_lab.benchmarks.gvb [RIG...] [--resolutions 16 ...] [--plot FILE] [--out FILE]

Times are those of one run on each rig; other work on the machine shows in them.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import cutcell
from cutcell.graph import build_graph
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.body import Body
from cutcell_lab.baselines.compare import Comparison, compare
from cutcell_lab.baselines.volumes.voxels import voxelize

from .document import fill
from .figures import METHOD_COLORS, save, styled
from .quality import warm
from .rigs import SHARED
from .tables import Table, seconds

SIDES = ("cutcell", "cutcell_any", "voxel", "voxel_unirig")
TITLE = "Beside geodesic voxel binding, over R"
COARSE, FINE = 64, 256
"""The paper: its prior at the one is ahead of voxels at the other."""


@dataclass(frozen=True)
class Size:
    """Nodes and edges of a graph, over all rigs the medians."""

    nodes: float
    edges: float


def graph_sizes(paths: Sequence[Path], resolution: int) -> dict[str, Size]:
    """Count what either graph holds: "cutcell" and "voxel"."""
    counts: dict[str, list[tuple[int, int]]] = {"cutcell": [], "voxel": []}
    for path in paths:
        rig = cutcell.load(path)
        graph = build_graph(rig.mesh, resolution, connectivity=6)
        counts["cutcell"].append((len(graph.nodes), len(graph.edges)))
        voxels = voxelize(Body.of(rig, resolution=resolution))
        counts["voxel"].append((len(voxels.centres), len(voxels.links()[0])))
    return {name: Size(*np.median(pairs, axis=0)) for name, pairs in counts.items()}


def measured(paths: Sequence[Path], resolutions: Sequence[int]) -> dict[int, Comparison]:
    """Compare the methods at each resolution."""
    methods = {name: METHODS[name] for name in SIDES}
    warm(methods)
    comparisons = {}
    for resolution in resolutions:
        print(f"R = {resolution}", file=sys.stderr, flush=True)
        comparisons[resolution] = compare(
            # Clips are not in these tables, and to play all of them takes most of the time.
            (replace(cutcell.load(path), clips=()) for path in paths),
            methods,
            resolution=resolution,
        )
    return comparisons


def accuracy_table(comparisons: dict[int, Comparison]) -> Table:
    """Write medians and means, the better side of each line in bold."""
    count = len(next(iter(comparisons.values())).rigs)
    table = Table(
        TITLE,
        ["R", "measure", *SIDES],
        f"Median, mean over {count} rigs. `voxel`: Dionne & de Lasa with bones as segments and 26 "
        "neighbours; `voxel_unirig`: as UniRig prepares it. The least median and the least mean "
        "are bold.",
    )
    for resolution, comparison in comparisons.items():
        for measure, title, digits in (("l1", "L1", 3), ("deformation", "cm²", 1)):
            statistics = [comparison.statistic(name, measure) for name in SIDES]
            columns = []
            for kind in ("median", "mean"):
                values = [round(float(getattr(s, kind)), digits) for s in statistics]
                best = min(values)
                columns.append(
                    [f"**{v:.{digits}f}**" if v == best else f"{v:.{digits}f}" for v in values]
                )
            table.add(resolution, title, *(", ".join(pair) for pair in zip(*columns, strict=True)))
    return table


def coarse_table(comparisons: dict[int, Comparison]) -> Table:
    """Put the cut-cell prior on a coarse grid beside voxels on a fine one, rig by rig."""
    cutcells, voxels = ("cutcell", "cutcell_any"), ("voxel", "voxel_unirig")
    heads = [
        *(f"{name}, {COARSE}" for name in cutcells),
        *(f"{name}, {FINE}" for name in voxels),
    ]
    table = Table(
        f"R = {COARSE} against voxels at R = {FINE}",
        ["rig", *heads],
        f"L1 / cm² of each; `ahead`: rigs on which the method at R = {COARSE} has less than voxels "
        f"at R = {FINE}.",
    )
    values: dict[str, list[tuple[float, float]]] = {name: [] for name in (*cutcells, *voxels)}
    for coarse, fine in zip(comparisons[COARSE].rigs, comparisons[FINE].rigs, strict=True):
        for names, rig in ((cutcells, coarse), (voxels, fine)):
            for score in rig.scores:
                if score.method in names:
                    l1, moved = (score.values.get(name) for name in ("l1", "deformation"))
                    values[score.method].append((float(l1 or np.nan), float(moved or np.nan)))
        cells = (values[name][-1] for name in (*cutcells, *voxels))
        table.add(coarse.name, *(f"{l1:.3f} / {moved:.1f}" for l1, moved in cells))
    for their in voxels:
        ahead = [np.array(values[our]) < np.array(values[their]) for our in cutcells]
        cells = [" / ".join(str(n) for n in less.sum(axis=0)) for less in ahead]
        cells += [f"of {len(values[their])}" if name == their else "" for name in voxels]
        table.add(f"ahead of {their}", *cells)
    return table


def cost_table(comparisons: dict[int, Comparison], sizes: dict[int, dict[str, Size]]) -> Table:
    """Write time and size."""
    heads = [f"{name}, time" for name in SIDES]
    table = Table(
        "Cost over R",
        ["R", *heads, "cut-cell nodes, edges", "voxels, links"],
        "Medians over the same rigs.",
    )
    for resolution, comparison in comparisons.items():
        spent = [comparison.statistic(name, "seconds").median for name in SIDES]
        sizes_text = [f"{s.nodes:,.0f}, {s.edges:,.0f}" for s in sizes[resolution].values()]
        table.add(resolution, *(seconds(float(s or 0)) for s in spent), *sizes_text)
    return table


def plot(comparisons: dict[int, Comparison], sizes: dict[int, dict[str, Size]], path: Path) -> None:
    """Draw error, time and size over R."""
    figure, axes = styled(1, 4, (11.0, 3.1))
    resolutions = list(comparisons)
    for name in SIDES:
        for panel, measure in zip(axes, ("l1", "deformation", "seconds"), strict=False):
            y = [comparisons[r].statistic(name, measure).median for r in resolutions]
            panel.plot(resolutions, y, "o-", color=METHOD_COLORS[name], label=name, markersize=4)
    for name in ("cutcell", "voxel"):
        y = [sizes[r][name].nodes for r in resolutions]
        axes[3].plot(resolutions, y, "o-", color=METHOD_COLORS[name], markersize=4)
    titles = ("Median L1", "Median deformation, cm²", "Median seconds", "Median nodes")
    for panel, title in zip(axes, titles, strict=True):
        panel.set_title(title, loc="left", fontsize=9.5, fontweight="bold")
        panel.set_xscale("log", base=2)
        panel.set_xticks(resolutions, [str(r) for r in resolutions])
    axes[2].set_yscale("log")
    axes[3].set_yscale("log")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=4, frameon=False)
    save(figure, path, bottom=0.1)


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.gvb", description=__doc__
    )
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--resolutions", nargs="+", type=int, default=[16, 32, 64, 128, 256])
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    paths = options.rigs or sorted((SHARED / "rigs").glob("*.glb"))
    if not paths:
        sys.exit(f"there are no rigs in {SHARED / 'rigs'}; name some")
    comparisons = measured(paths, options.resolutions)
    sizes = {r: graph_sizes(paths, r) for r in options.resolutions}
    tables = [accuracy_table(comparisons), cost_table(comparisons, sizes)]
    if COARSE in comparisons and FINE in comparisons:
        tables.append(coarse_table(comparisons))
    text = "\n\n".join(table.markdown() for table in tables)
    print(text)
    if options.plot:
        plot(comparisons, sizes, options.plot)
    if options.out:
        fill(options.out, {"gvb": text})


if __name__ == "__main__":
    main()
