"""How long it takes to bind again after a joint has moved, the graph being known.

python -m benchmarks.rebinding [RIG ...] [--moves 40] [--out docs/performance.md]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import cutcell
from cutcell_lab.benchmarks.document import fill
from cutcell_lab.benchmarks.rigs import rig_paths
from cutcell_lab.benchmarks.tables import Table

STEP = 0.005
"""Step of a joint, relative to the longest side, as under a pointer."""


def rebinding_table(rigs: Sequence[cutcell.Rig], moves: int, resolution: int) -> Table:
    """Move random joints of each rig, and bind again."""
    columns = ["rig", "vertices", "joints", "fresh", "median", "95 %", "off by"]
    note = (
        f"Milliseconds, R = {resolution}; {moves} times a random joint moves by {STEP:.1%} of the "
        "longest side, and `bind(rig, graph=...)` is called. `off by`: the largest difference from "
        "a fresh binding, of the last three."
    )
    table = Table("Binding again with a moved joint", columns, note)
    for rig in rigs:
        cutcell.bind(rig, resolution)
        start = time.perf_counter()
        binding = cutcell.bind(rig, resolution)
        fresh = time.perf_counter() - start
        rng = np.random.default_rng(5)
        spent, off = [], 0.0
        joints, unit = rig.skeleton.joints.copy(), STEP * np.ptp(rig.mesh.bounds, axis=0).max()
        for move in range(moves):
            joints = joints.copy()
            step = rng.standard_normal(3)
            joints[rng.integers(len(joints))] += unit * step / np.linalg.norm(step)
            moved = replace(rig, skeleton=replace(rig.skeleton, joints=joints))
            start = time.perf_counter()
            again = cutcell.bind(moved, resolution, graph=binding.graph)
            spent.append(1000 * (time.perf_counter() - start))
            if move >= moves - 3:
                changes = cutcell.bind(moved, resolution).weights
                off = max(off, float(np.abs(again.weights - changes).max()))
        middle, slow = np.percentile(spent, [50, 95])
        counts = f"{len(rig.mesh.vertices):,}", len(joints)
        times = (f"{value:.0f}" for value in (1000 * fresh, middle, slow))
        table.add(rig.name, *counts, *times, f"{off:.0e}")
    return table


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--moves", type=int, default=40)
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    rigs = [cutcell.load(path) for path in rig_paths(options.rigs)]
    text = rebinding_table(rigs, options.moves, options.resolution).markdown()
    print(text)
    if options.out:
        fill(options.out, {"rebinding": text})


if __name__ == "__main__":
    main()
