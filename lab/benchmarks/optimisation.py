"""Time of shortest paths against that of optimisation (the paper's Figure "geodesics").

    python -m cutcell_lab.benchmarks.optimisation [RIG...] [--resolution 64] [--repeats 3]

Making tetrahedra or graph is left out, as in the paper: from there to weights.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cutcell_lab.baselines import METHODS, BaselineBinding

from .document import fill
from .quality import LIMIT, warm
from .rigs import Character, load_characters
from .tables import Table, ratio, seconds

OURS = ("cutcell", "cutcell_any")
SOLVERS = ("biharmonic", "quasi_harmonic", "bbw")
MAKING = {"graph", "tetrahedra"}


def spent(binding: BaselineBinding) -> float:
    """Add up the stages after the graph or the tetrahedra."""
    if binding.weights is None:
        return np.nan
    return sum(value for stage, value in binding.seconds.items() if stage not in MAKING)


def optimisation_table(
    characters: Sequence[Character], resolution: int, repeats: int, limit: float
) -> Table:
    """Measure all on each rig: ours the least of several runs, solvers once."""
    warm({name: METHODS[name] for name in OURS})
    table = Table(
        "Shortest paths against optimisation",
        ["rig", *OURS, *SOLVERS],
        f"Seconds from graph (R = {resolution}) or tetrahedra to weights; in brackets how many "
        f"times as long as {OURS[-1]} takes. Quasi-harmonic weights take twenty steps.",
    )
    for character in characters:
        rig, spent_by = character.rig, {}
        for name in OURS:
            runs = [spent(METHODS[name](rig, resolution=resolution)) for _ in range(repeats)]
            spent_by[name] = min(runs)
        for name in SOLVERS:
            spent_by[name] = spent(METHODS[name](rig, limit=limit))
        base = spent_by[OURS[-1]]
        cells = [seconds(spent_by[name]) for name in OURS]
        for name in SOLVERS:
            value = spent_by[name]
            finite = np.isfinite(value)
            cells.append(f"{seconds(value)} ({ratio(value / base)})" if finite else "failed")
        table.add(f"{character.name} ({character.size})", *cells)
    return table


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.optimisation", description=__doc__
    )
    parser.add_argument("rigs", nargs="*", help="all at hand when left out")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--limit", type=float, default=LIMIT)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    characters = load_characters(options.rigs)
    table = optimisation_table(characters, options.resolution, options.repeats, options.limit)
    text = table.markdown()
    print(text)
    if options.out:
        fill(options.out, {"optimisation": text})


if __name__ == "__main__":
    main()
