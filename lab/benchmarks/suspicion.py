"""Suspicious weights, by `cutcell.diagnose`, of artists, and in those of other methods.

    python -m cutcell_lab.benchmarks.suspicion [RIG ...] [--resolution 64] [--out docs/diagnose.md]

Nothing is compared with the artist's weights here: each set of weights is examined by itself.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import cutcell
from cutcell.errors import CutcellError
from cutcell_lab.baselines import METHODS

from .diagnosis import wild_paths
from .document import fill
from .rigs import rig_paths
from .tables import Table

CODES = {
    "stray-weights": "stray",
    "leaked-weights": "leaked",
    "weight-islands": "islands",
    "stretched-surface": "surface",
    "stretched-edges": "edges",
    "flipped-faces": "flipped",
    "lost-volume": "volume",
    "asymmetric-weights": "unlike",
}
SETS = ("file", "cutcell", "voxel", "euclidean")


def weights_of(rig: cutcell.Rig, method: str, resolution: int) -> np.ndarray | None:
    """Return one set of weights of a rig; None where there is none."""
    if method == "file":
        return rig.weights
    if method == "cutcell":
        return cutcell.bind(rig, resolution).weights
    options = {"resolution": resolution} if method == "voxel" else {}
    return METHODS[method](rig, **options).weights


def suspicion_tables(paths: Sequence[Path], resolution: int) -> list[Table]:
    """Examine all rigs; return what is found of each, and how often."""
    note = (
        f"R = {resolution}. How many vertices each finding names, with `!` where it is a warning; "
        "several sets of weights for one character. `-` where nothing is found."
    )
    each = Table("Suspicious weights", ["character", "weights", *CODES.values()], note)
    often = {method: np.zeros(len(CODES) + 2, int) for method in SETS}
    for path in paths:
        name = path.stem if path.suffix != ".gltf" else path.parent.name
        try:
            rig = cutcell.load(path)
        except CutcellError:
            continue
        if rig.weights is None or not rig.weights.any():
            continue
        for method in SETS:
            weights = weights_of(rig, method, resolution)
            if weights is None:
                continue
            results = cutcell.diagnose(rig.with_weights(weights), resolution)
            grave = [code in results and results[code].severity == "warning" for code in CODES]
            often[method] += [1, any(grave), *grave]
            row = name, method, *(_cell(results, code) for code in CODES)
            each.add(*row)
            print(*row, flush=True)
    summary = Table(
        "How often weights are suspicious",
        ["weights", "characters", "with any", *CODES.values()],
        "Characters with each finding as a warning.",
    )
    for method, counts in often.items():
        summary.add(method, *counts)
    return [summary, each]


def _cell(results: cutcell.Diagnosis, code: str) -> str:
    if code not in results:
        return "-"
    finding = results[code]
    return f"{len(finding.vertices):,}" + "!" * (finding.severity == "warning")


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, examine, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    paths = options.rigs or [*rig_paths(), *wild_paths()]
    text = "\n\n".join(table.markdown() for table in suspicion_tables(paths, options.resolution))
    print(text)
    if options.out:
        fill(options.out, {"suspicion": text})


if __name__ == "__main__":
    main()
