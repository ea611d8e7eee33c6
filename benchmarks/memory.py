"""The most memory that binding takes, rig by rig, each in a subprocess.

python -m benchmarks.memory [RIG...] [--resolution 256] [--connectivity any 6] [--markdown OUT]

The whole process counts: Python, libraries, compiled kernels, the rig and all results. Beside it
is the graph's estimate of this binding, see `cutcell/graph/memory.py`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from cutcell.graph.memory import needed_memory
from cutcell_lab.benchmarks.rigs import ROOT, rig_paths
from cutcell_lab.benchmarks.tables import Table, publish, seconds

from .growth import run

LARGE = ROOT / "assets" / "biped.glb", 512


def memory_table(cases: Sequence[dict], options: argparse.Namespace) -> Table:
    """Measure cases one after the other; the last row is the worst of each column."""
    table = Table(
        "Peak memory",
        ["rig", "R", "connectivity", "nodes", "all", "peak memory", "above start", "reckoned"],
        "`bind` with its defaults but for the connectivity, each in a new process, whose start "
        "counts too. What lies above the start is beside what the check reckons that refuses "
        "graphs which would not fit.",
    )
    peaks, shares = [], []
    for case in cases:
        outcome = run(case, options)
        name = Path(case["rig"]).stem
        print(f"{name}, R={case['resolution']}, {case['connectivity']}", file=sys.stderr)
        expected = name, case["resolution"], case["connectivity"]
        if isinstance(outcome, str):
            table.add(*expected, outcome, *["-"] * 4)
            continue
        above = outcome["peak"] - outcome["before"]
        peaks.append(outcome["peak"])
        reckoned = needed_memory(*outcome["kinds"], case["connectivity"]) / 2**20
        shares.append(above / reckoned)
        table.add(
            *expected,
            f"{outcome['nodes']:,}",
            seconds(outcome["seconds"]),
            f"{peaks[-1]:,.0f} MB",
            f"{above:,.0f} MB",
            f"{reckoned:,.0f} MB",
        )
    if peaks:
        most = f"{max(peaks):,.0f} MB", f"{max(shares):.0%} of what is reckoned", ""
        table.add("**most**", "", "", "", "", *most)
    return table


def tables(options: argparse.Namespace) -> list[Table]:
    """Measure all rigs at one resolution, then a compact one at twice that."""
    cases = [
        {"rig": str(path), "resolution": options.resolution, "connectivity": connectivity}
        for path in rig_paths(options.rigs)
        for connectivity in options.connectivity
    ]
    if not options.rigs:
        path, resolution = LARGE
        cases += [
            {"rig": str(path), "resolution": resolution, "connectivity": connectivity}
            for connectivity in options.connectivity
        ]
    return [memory_table(cases, options)]


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.memory", description=__doc__)
    parser.add_argument("rigs", nargs="*", metavar="RIG", help="all at hand when left out")
    parser.add_argument("--resolution", type=int, default=256, metavar="R")
    parser.add_argument(
        "--connectivity", nargs="+", default=["any", 6], type=lambda c: c if c == "any" else int(c)
    )
    parser.add_argument("--limit", type=float, default=300, help="seconds for one rig")
    parser.add_argument("--markdown", type=Path, metavar="OUT")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table, and write it too if a file is named."""
    options = arguments(argv)
    publish(tables(options), options.markdown)


if __name__ == "__main__":
    main()
