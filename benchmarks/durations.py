"""How long the tests take, by folder: `python -m benchmarks.durations BEFORE.xml AFTER.xml`.

The files are what pytest writes with --junitxml.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter, defaultdict
from pathlib import Path
from xml.etree import ElementTree

from cutcell_lab.benchmarks.tables import Table, publish

NIGHTLY = "wheel, full disk and benchmarks: nightly"
BROWSER = "browser"
MOVED = re.compile(r"^tests\.cutcell\.(?=baselines|dataset|networks)")
"""Folders that the laboratory has now."""


def folder_of(test: str) -> str:
    """Return the row of a test, named as in a file of --junitxml."""
    folder, *_ = MOVED.sub("tests.lab.", test).removeprefix("tests.").split(".")
    if ".test_browser" in test:
        return BROWSER
    if folder in ("benchmarks", "test_wheel", "test_full_disk"):
        return NIGHTLY
    return "the root of tests" if folder.startswith("test_") else f"tests/{folder}"


def read(path: Path) -> tuple[Counter[str], dict[str, float]]:
    """Return the number of tests in each folder, and their seconds, set-up included."""
    counts: Counter[str] = Counter()
    seconds: dict[str, float] = defaultdict(float)
    for case in ElementTree.parse(path).iter("testcase"):
        folder = folder_of(case.attrib["classname"])
        counts[folder] += 1
        seconds[folder] += float(case.attrib["time"])
    return counts, seconds


def table(before: Path, after: Path) -> Table:
    """Compare two runs, slowest folder first; the browser's tests are no part of the sum."""
    (counts, seconds), (new_counts, new_seconds) = read(before), read(after)
    result = Table(
        "Tests",
        ["folder", "tests before", "tests after", "seconds before", "seconds after", "share"],
        "Seconds are summed over all tests, as each worker counts them.",
    )
    rows = sorted(seconds.keys() - {BROWSER}, key=lambda name: -seconds[name])
    for name, members in [*((row, [row]) for row in rows), ("**all**", rows), (BROWSER, [BROWSER])]:
        sums = [sum(c[one] for one in members) for c in (counts, new_counts, seconds, new_seconds)]
        if sums[0] and sums[1]:
            share = f"{sums[3] / sums[2]:.0%}"
            result.add(name, *sums[:2], f"{sums[2]:.0f}", f"{sums[3]:.0f}", share)
    return result


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.durations")
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    options = parser.parse_args()
    publish([table(options.before, options.after)], None)


if __name__ == "__main__":
    main()
