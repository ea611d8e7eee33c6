"""How much memory and time a class takes: sessions that arrive at once, and compute at once.

python -m benchmarks.classroom [--sessions 1 4 8] [--write]
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Sequence

from cutcell_lab.benchmarks.document import fill
from cutcell_lab.benchmarks.rigs import ROOT
from cutcell_lab.benchmarks.tables import Table

from .report import circumstances
from .visitors import BOUND, Visitor, served

HOSTING = ROOT / "docs" / "hosting.md"
RESOLUTIONS = range(40, 64)
"""Resolutions that students choose: each another, so that no session uses another's graph."""
POLL = 0.05


def arrive(address: str, queries: Sequence[str]) -> tuple[list[Visitor], list[float]]:
    """Open sessions at once; return them, and the seconds after which each was bound."""
    begin = time.monotonic()
    visitors = [Visitor(address, query) for query in queries]
    seconds: dict[Visitor, float] = {}
    while len(seconds) < len(visitors):
        for visitor in visitors:
            if visitor not in seconds and visitor.has_heard(BOUND):
                seconds[visitor] = time.monotonic() - begin
        time.sleep(POLL)
    return visitors, list(seconds.values())


def classroom_table(counts: Sequence[int]) -> Table:
    """Let classes of some sizes arrive, each at a server of its own."""
    load = os.getloadavg()[0]
    table = Table(
        "Sessions of a class",
        ["sessions", "server, MB", "a session, MB", "bound, median, s", "bound, last, s"],
        "All arrive within a moment, each with another resolution of the first demo, so that each "
        "computes a graph of its own. Other programs used the cores at the same time: "
        f"load {load:.1f} at the beginning.",
    )  # fmt: skip
    for count in counts:
        with served() as server:
            first, _ = arrive(server.address, [""])
            before = server.megabytes()
            queries = [f"?rig=biped&resolution={RESOLUTIONS[k % len(RESOLUTIONS)]}"
                       for k in range(count)]  # fmt: skip
            visitors, seconds = arrive(server.address, queries)
            total = server.megabytes()
            table.add(
                str(count), f"{total:.0f}", f"{(total - before) / count:.0f}",
                f"{statistics.median(seconds):.1f}", f"{max(seconds):.1f}",
            )  # fmt: skip
            for visitor in [*first, *visitors]:
                visitor.close()
    return table


def main(argv: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.classroom", description=__doc__)
    parser.add_argument("--sessions", type=int, nargs="+", default=[1, 4, 8])
    parser.add_argument("--write", action="store_true", help="into docs/hosting.md")
    options = parser.parse_args(argv)
    text = f"{circumstances()}\n\n{classroom_table(options.sessions).markdown()}\n"
    print(text, end="")
    if options.write:
        fill(HOSTING, {"classroom": text})


if __name__ == "__main__":
    main()
