"""Measure every method on real characters, and write the tables of docs/quality.md.

    python -m cutcell_lab.benchmarks.quality                       measure all, and write docs/
    python -m cutcell_lab.benchmarks.quality --methods A,B         these again, keep the others
    python -m cutcell_lab.benchmarks.quality RIG... [--methods A,B] [--json FILE] [--plot FILE]

The first form takes an hour or more, most of it tetrahedra, and keeps what it has in
docs/quality.json after each rig: with --resume it continues after the last one. It measures
the rigs in ../shared/data/rigs; where ../shared/data/bone_heat holds Blender's automatic weights
of a rig, they are a separate method. With rigs named it only prints.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from functools import partial
from inspect import signature
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import cutcell
from cutcell.rig import Rig
from cutcell.runtime.writing import write_all
from cutcell_lab.baselines import METHODS, BaselineBinding
from cutcell_lab.baselines.compare import Comparison, compare, comparison_markdown
from cutcell_lab.baselines.compare.plot import plot_comparison

from ..metrics.deformation import longest_side
from .document import fill
from .rigs import ROOT, SHARED
from .shapes import small

SAME_PLACE = 1e-4
"""Largest distance to a vertex of Blender's that is the same one, relative to the longest side."""
LIMIT = 300.0
"""Seconds that a mesher or solver in a subprocess may take."""


def blender(rig: Rig, folder: Path) -> BaselineBinding:
    """Read what Blender's automatic weights are for a rig, matched by position."""
    path = folder / f"{rig.name}.npz"
    if not path.exists():
        return BaselineBinding(None, failed="there is no stored result for this file")
    with np.load(path) as data:
        away, row = cKDTree(data["vertices"]).query(rig.mesh.vertices)
        if away.max() > SAME_PLACE * longest_side(rig.mesh):
            return BaselineBinding(None, failed=f"{path.name} is of another mesh")
        column = columns(rig, [str(name) for name in data["joint_names"]])
        weights = data["weights"][row][:, column].astype(float)
        seconds = float(data["seconds"])
    # Blender did not know which joints the artist left empty: their weight is dropped, but
    # for vertices that have no other.
    carrying = np.where(rig.skeleton.deform, weights, 0)
    carrying = np.where(carrying.any(axis=1, keepdims=True), carrying, weights)
    total = carrying.sum(axis=1, keepdims=True)
    weights = np.divide(carrying, total, out=np.zeros_like(carrying), where=total > 0)
    return BaselineBinding(weights, {"weights": seconds})


def columns(rig: Rig, names: list[str]) -> list[int]:
    """Find each joint of a rig among the names; by order where the file names none."""
    if not any(names) and len(names) == len(rig.skeleton.names):
        return list(range(len(names)))
    return [names.index(name) for name in rig.skeleton.names]


def chosen(names: str | None, limit: float) -> dict:
    """Look methods up; all of them when none is named. Ends the script at an unknown one."""
    available = {**METHODS, "blender": partial(blender, folder=SHARED / "bone_heat")}
    requested = list(available) if names is None else [name.strip() for name in names.split(",")]
    if unknown := [name for name in requested if name not in available]:
        sys.exit(f"unknown: {', '.join(unknown)}; known: {', '.join(available)}")
    return {
        name: partial(available[name], limit=limit)
        if "limit" in signature(available[name]).parameters
        else available[name]
        for name in requested
    }


def measured(
    paths: Sequence[Path], methods: dict, resolution: int, earlier: Comparison, keep: Path | None
) -> Comparison:
    """Compare rig by rig, and keep what there is after each."""
    for path in paths:
        print(path.stem, file=sys.stderr, flush=True)
        try:
            comparison = compare([cutcell.load(path)], methods, resolution=resolution)
        except cutcell.CutcellError as error:
            print(f"{path.name} is left out: {error}", file=sys.stderr, flush=True)
            continue
        earlier = earlier.merged(comparison)
        if keep:
            write_all({keep: (json.dumps(earlier.to_dict(), indent=1) + "\n").encode()})
    return earlier


def warm(methods: dict) -> None:
    """Bind a small ball by each method, so that none pays for the compiling of its loops."""
    rig = small()
    for name, method in methods.items():
        coarse = {"resolution": 16} if name == "voxel_unirig" else {}  # 196 takes seconds
        method(rig, **coarse)


def read(path: Path) -> Comparison:
    """Read what an earlier run kept."""
    if not path.exists():
        return Comparison((), ())
    return Comparison.from_dict(json.loads(path.read_text(encoding="utf-8")))


def write_docs(comparison: Comparison, docs: Path, resolution: int) -> None:
    """Write the tables into docs/quality.md, and the figure that it shows."""
    text = comparison_markdown(comparison).replace("## ", "### ")
    fill(docs / "quality.md", {"tables": f"R = {resolution}.\n\n{text}"})
    plot_comparison(comparison, docs / "pictures" / "quality.png")


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.quality",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--methods", help="names with commas between; all when left out")
    parser.add_argument("--resolution", type=int, default=64, help="R; 64 when left out")
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds, of other processes")
    parser.add_argument("--json", type=Path, help="write all numbers to this file")
    parser.add_argument("--plot", type=Path, help="draw the figure into this file")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="the folder to write")
    parser.add_argument("--resume", action="store_true", help="skip rigs that are there already")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print or write."""
    options = arguments(argv)
    methods = chosen(options.methods, options.limit)
    if options.rigs:
        warm(methods)
        none = Comparison((), ())
        comparison = measured(options.rigs, methods, options.resolution, none, options.json)
        print(comparison_markdown(comparison))
        if options.plot:
            plot_comparison(comparison, options.plot)
        return
    rigs = sorted((SHARED / "rigs").glob("*.glb"))
    if not rigs:
        sys.exit(f"there are no rigs in {SHARED / 'rigs'}; name some")
    keep = options.docs / "quality.json"
    earlier = read(keep) if options.methods or options.resume else Comparison((), ())
    if options.resume:
        done = {
            rig.name
            for rig in earlier.rigs
            if not set(methods) - {s.method for s in rig.scores if s.failed != "not measured"}
        }
        rigs = [path for path in rigs if path.stem not in done]
    warm(methods)
    comparison = measured(rigs, methods, options.resolution, earlier, keep)
    write_docs(comparison, options.docs, options.resolution)


if __name__ == "__main__":
    main()
