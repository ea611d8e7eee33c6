"""How fast `bind` and its stages are beside an earlier version of the code, timed in turn.

    python -m benchmarks.versions CHECKOUT [RIG...] [--resolutions 64 128] [--repeats 5]

CHECKOUT is a folder with a version of the code and its own `.venv`. A process for each version
binds the same files, one after the other, so that whatever else the machine does meets both alike.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from cutcell_lab.benchmarks.rigs import ROOT, rig_paths
from cutcell_lab.benchmarks.tables import Table, publish

STAGES = ("graph", "distances", "weights", "all of bind")
WORKER = """
import json, sys
from time import perf_counter
import cutcell
rigs = {}
for line in sys.stdin:
    path, resolution = json.loads(line)
    if path not in rigs:
        rigs[path] = cutcell.load(path)
    begin = perf_counter()
    seconds = cutcell.bind(rigs[path], resolution).seconds
    print(json.dumps([*(seconds[stage] for stage in ("graph", "distances", "weights")),
                      perf_counter() - begin]), flush=True)
"""
"""What a process of any version runs: it needs nothing of this one."""


class Version:
    """A process that binds files by one version of the code."""

    def __init__(self, checkout: Path, stack: ExitStack) -> None:
        self.process = stack.enter_context(
            subprocess.Popen(
                [checkout.resolve() / ".venv/bin/python", "-W", "ignore", "-c", WORKER],
                cwd=checkout,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        )

    def seconds(self, path: Path, resolution: int) -> list[float]:
        """Bind a file; return the seconds of each stage."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps([str(path.resolve()), resolution]), file=self.process.stdin, flush=True)
        answer: list[float] = json.loads(self.process.stdout.readline())
        return answer


def ratio_table(options: argparse.Namespace) -> Table:
    """Time all files by both versions."""
    table = Table(
        f"Seconds of this version, relative to those of {options.checkout.name}",
        ["rig", "R", *STAGES],
        f"Ratios of medians over {options.repeats} rounds in turn; below 1 this version is faster.",
    )
    with ExitStack() as stack:
        versions = [Version(checkout, stack) for checkout in (ROOT, options.checkout)]
        for resolution in options.resolutions:
            ratios = []
            for path in rig_paths(options.rigs):
                for version in versions:
                    version.seconds(path, resolution)  # not counted: it compiles and fills caches
                rounds = [
                    [version.seconds(path, resolution) for version in versions]
                    for _ in range(options.repeats)
                ]
                ours, others = np.median(rounds, axis=0)
                ratios.append(ours / others)
                table.add(path.stem, resolution, *map("{:.2f}".format, ratios[-1]))
                print(f"{path.stem}, R={resolution}", file=sys.stderr, flush=True)
            table.add("**median**", resolution, *map("{:.2f}".format, np.median(ratios, axis=0)))
            table.add("**largest**", resolution, *map("{:.2f}".format, np.max(ratios, axis=0)))
    return table


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("checkout", type=Path)
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--resolutions", nargs="+", type=int, default=[64, 128])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--markdown", type=Path)
    return parser.parse_args(argv)


if __name__ == "__main__":
    given = arguments()
    publish([ratio_table(given)], given.markdown)
