"""The graph's construction against meshers, over R (the paper's Table "graph construction").

    python -m benchmarks.graph_construction [RIG...] [--resolutions 8 16 32 64] [--limit 60]

fTetWild aims at edges of 1/R of the longest side, TetGen keeps the surface as it is, whatever R.
Each mesher runs in a process of its own, whose start does not count. Mandoline, the paper's third
side, has no package to install and is left out.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cutcell.graph import build_graph

from .document import fill
from .mesher import MESHERS
from .meshers import attempt
from .rigs import Character, load_characters
from .tables import Table, ratio, seconds
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
        ours, theirs = [], {name: [] for name in meshers}
        for character in characters:
            mesh = character.rig.mesh
            ways = {"graph": lambda m=mesh, r=resolution: build_graph(m, r, connectivity=6)}
            ours.append(min(in_turn(ways, options.repeats)["graph"].seconds))
            for name in meshers:
                key = (name, character.name) if name == "tetgen" else None
                found = fixed.get(key) if key else None
                if found is None:
                    edge = 1 / resolution
                    found = attempt(name, character, options.mesher_python, options.limit, edge)
                if key:
                    fixed[key] = found
                theirs[name].append(found)
            print(f"R = {resolution}: {character.name}", file=sys.stderr, flush=True)
        cells = [_cell(found, ours) for found in theirs.values()]
        table.add(resolution, seconds(float(np.mean(ours))), *cells)
    return table


def _cell(found: list[dict | str], ours: list[float]) -> str:
    """Put the runs of one mesher into words."""
    good = [k for k, one in enumerate(found) if not isinstance(one, str)]
    if not good:
        return ", ".join(dict.fromkeys(str(one) for one in found))
    mean = float(np.mean([found[k]["seconds"] for k in good]))  # type: ignore[index]
    times = ratio(mean / float(np.mean([ours[k] for k in good])))
    some = "" if len(good) == len(found) else f", {len(good)} of {len(found)} rigs"
    return f"{seconds(mean)} ({times}{some})"


def main(given: Sequence[str] | None = None) -> None:
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
    options = parser.parse_args(given)
    text = construction_table(load_characters(options.rigs), options, list(MESHERS)).markdown()
    print(text)
    if options.out:
        fill(options.out, {"construction": text})


if __name__ == "__main__":
    main()
