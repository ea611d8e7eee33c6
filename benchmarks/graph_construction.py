"""The graph's construction against meshers, over R (the paper's Table "graph construction").

    python -m benchmarks.graph_construction [RIG...] [--resolutions 8 16 32 64] [--limit 60]

fTetWild aims at edges of 1/R of the longest side, TetGen keeps the surface as it is, whatever R.
Each mesher runs in a subprocess, whose start does not count. Mandoline, the paper's third
side, has no package to install and is left out.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cutcell.graph import build_graph
from cutcell_lab.benchmarks.document import fill
from cutcell_lab.benchmarks.rigs import Character, load_characters
from cutcell_lab.benchmarks.tables import Table, ratio, seconds

from .mesher import MESHERS
from .meshers import attempt
from .timing import in_turn


def construction_table(
    characters: Sequence[Character], options: argparse.Namespace, meshers: Sequence[str]
) -> Table:
    """Average over the rigs; a mesher's mean is over those that it managed, the count beside it."""
    table = Table(
        "Graph construction",
        ["R", "cutcell", *meshers],
        f"Mean over {', '.join(c.name for c in characters)}; in brackets how many times as long as "
        f"ours; a mesher may take {options.limit:g} s for each.",
    )
    fixed: dict[tuple[str, str], dict | str] = {}
    for resolution in options.resolutions:
        graph_seconds, runs = [], {name: [] for name in meshers}
        for character in characters:
            mesh = character.rig.mesh
            ways = {"graph": lambda m=mesh, r=resolution: build_graph(m, r, connectivity=6)}
            graph_seconds.append(min(in_turn(ways, options.repeats)["graph"].seconds))
            for name in meshers:
                key = (name, character.name) if name == "tetgen" else None
                run = fixed.get(key) if key else None
                if run is None:
                    edge = 1 / resolution
                    run = attempt(name, character, options.mesher_python, options.limit, edge)
                if key:
                    fixed[key] = run
                runs[name].append(run)
            print(f"R = {resolution}: {character.name}", file=sys.stderr, flush=True)
        cells = [_cell(run, graph_seconds) for run in runs.values()]
        table.add(resolution, seconds(float(np.mean(graph_seconds))), *cells)
    return table


def _cell(run: list[dict | str], graph_seconds: list[float]) -> str:
    """Put the runs of one mesher into words."""
    good = [k for k, one in enumerate(run) if not isinstance(one, str)]
    if not good:
        return ", ".join(dict.fromkeys(str(one) for one in run))
    mean = float(np.mean([run[k]["seconds"] for k in good]))  # type: ignore[index]
    times = ratio(mean / float(np.mean([graph_seconds[k] for k in good])))
    partial = "" if len(good) == len(run) else f", {len(good)} of {len(run)} rigs"
    return f"{seconds(mean)} ({times}{partial})"


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.graph_construction", description=__doc__
    )
    parser.add_argument("rigs", nargs="*", help="all at hand when left out")
    parser.add_argument("--resolutions", nargs="+", type=int, default=[8, 16, 32, 64, 128])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--mesher-python", default=sys.executable)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    text = construction_table(load_characters(options.rigs), options, list(MESHERS)).markdown()
    print(text)
    if options.out:
        fill(options.out, {"construction": text})


if __name__ == "__main__":
    main()
