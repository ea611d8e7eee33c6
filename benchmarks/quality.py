"""Measure every method on real characters, and print the tables of docs/quality.md.

    python -m benchmarks.quality [RIG...] [--methods NAME,...]
        [--resolution R] [--json FILE] [--markdown FILE]

Without rigs: all in ../shared/data/rigs. Where ../shared/data/bone_heat holds Blender's
automatic weights of a rig, they are a column of their own.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import cutcell
from cutcell.baselines import METHODS, BaselineBinding
from cutcell.compare import compare, comparison_markdown
from cutcell.metrics.deformation import longest_side
from cutcell.rig import Rig

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
SAME_PLACE = 1e-4
"""Of the longest side: farther from every vertex of Blender's, one has no counterpart."""


def blender(rig: Rig, folder: Path) -> BaselineBinding:
    """Read what Blender's automatic weights are for a rig, matched by position."""
    path = folder / f"{rig.name}.npz"
    if not path.exists():
        return BaselineBinding(None, failed=f"there is no {path.name} beside the other results")
    with np.load(path) as data:
        away, row = cKDTree(data["vertices"]).query(rig.mesh.vertices)
        if away.max() > SAME_PLACE * longest_side(rig.mesh):
            return BaselineBinding(None, failed=f"{path.name} is of another mesh")
        column = columns(rig, [str(name) for name in data["joint_names"]])
        weights = data["weights"][row][:, column].astype(float)
        seconds = float(data["seconds"])
    # Blender was not told which joints the artist left empty: their weight is dropped, but
    # for vertices that have no other.
    kept = np.where(rig.skeleton.deform, weights, 0)
    kept = np.where(kept.any(axis=1, keepdims=True), kept, weights)
    total = kept.sum(axis=1, keepdims=True)
    weights = np.divide(kept, total, out=np.zeros_like(kept), where=total > 0)
    return BaselineBinding(weights, {"weights": seconds})


def columns(rig: Rig, names: list[str]) -> list[int]:
    """Find each joint of a rig among the names; by order where the file names none."""
    if not any(names) and len(names) == len(rig.skeleton.names):
        return list(range(len(names)))
    return [names.index(name) for name in rig.skeleton.names]


def warmed(rigs: list[Path], methods: dict) -> None:
    """Bind one rig once, so that no method pays for the compiling of its loops."""
    rig = cutcell.load(rigs[0])
    for method in methods.values():
        method(rig)


def loaded(paths: list[Path]) -> Iterator[Rig]:
    """Load rigs one by one."""
    for path in paths:
        print(path.stem, file=sys.stderr, flush=True)
        yield cutcell.load(path)


def main(given: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.quality", description=__doc__.splitlines()[0]
    )
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--methods", help="names with commas between; all when left out")
    parser.add_argument("--resolution", type=int, default=64, help="R; 64 when left out")
    parser.add_argument("--json", type=Path, help="write all numbers to this file")
    parser.add_argument("--markdown", type=Path, help="write the tables to this file")
    options = parser.parse_args(given)
    rigs = options.rigs or sorted((DATA / "rigs").glob("*.glb"))
    if not rigs:
        sys.exit(f"there are no rigs in {DATA / 'rigs'}; name some")
    methods = {**METHODS, "blender": partial(blender, folder=DATA / "bone_heat")}
    if options.methods:
        names = options.methods.split(",")
        if unknown := [name for name in names if name not in methods]:
            sys.exit(f"unknown: {', '.join(unknown)}; known: {', '.join(methods)}")
        methods = {name: methods[name] for name in names}
    warmed(rigs, methods)
    comparison = compare(loaded(rigs), methods, resolution=options.resolution)
    text = comparison_markdown(comparison)
    print(text)
    if options.markdown:
        options.markdown.write_text(text, encoding="utf-8")
    if options.json:
        options.json.write_text(json.dumps(comparison.to_dict(), indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
