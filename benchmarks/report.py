"""Write docs/performance.md: all tables, with date and machine.

python -m benchmarks.report [--quick] [--out docs/performance.md]
"""

from __future__ import annotations

import argparse
import datetime
import os
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from cutcell.runtime.writing import write_all
from cutcell_lab.benchmarks import accuracy
from cutcell_lab.benchmarks.rigs import ROOT

from . import growth, memory, speed

PACKAGES = ("numpy", "numba", "scipy", "libigl", "embreex", "open3d")
INTRODUCTION = """\
# Performance

What `python -m benchmarks.report` printed on {date}, on {machine}.
Times are medians, the range of all runs in brackets; peers are timed in turn, A B A B, in
one process. Other work on the same machine shows as a wide range.

Each part can be run by itself: `python -m benchmarks.speed`, `.growth`, `.accuracy`, `.memory`.
"""


def machine() -> str:
    """Name processor, cores, memory and versions."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    versions = ", ".join(f"{name} {_version(name)}" for name in PACKAGES)
    return (
        f"{processor()}, {os.cpu_count()} cores, {memory:.0f} GB of memory, "
        f"{platform.system()}, Python {platform.python_version()}, {versions}"
    )


def circumstances() -> str:
    """Say when and where something is measured, and how busy the machine is with other work."""
    date, busy = datetime.date.today().isoformat(), os.getloadavg()[0]
    return f"Printed on {date}, on {machine()}; load before it began: {busy:.1f}."


def processor() -> str:
    """Name the processor."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "(not installed)"


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.report", description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "performance.md")
    parser.add_argument("--quick", action="store_true", help="two demos, low resolutions, once")
    parser.add_argument("--rigs", nargs="+", default=[], help="all at hand when left out")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--mesher-python", help="an interpreter that has pytetwild and tetgen")
    return parser.parse_args(argv)


def _speed(options: argparse.Namespace) -> list:
    argv = [str(path) for path in options.rigs]
    if options.quick:
        argv = argv or [str(ROOT / "assets" / f"{name}.glb") for name in ("biped", "robot")]
        argv += ["--resolutions", "32", "--repeats", "1", "--mesher-limit", "20"]
    else:
        argv += ["--repeats", str(options.repeats), "--cold"]
    if options.mesher_python:
        argv += ["--mesher-python", options.mesher_python]
    return speed.tables(speed.arguments(argv))


def _accuracy(options: argparse.Namespace) -> list:
    argv = ["--resolutions", "16", "32"] if options.quick else ["--repeats", "3"]
    return accuracy.tables(accuracy.arguments(argv))


def _growth(options: argparse.Namespace) -> list:
    few = {"--resolutions": ["16", "32", "64"], "--faces": ["1280", "5120"], "--bones": ["1", "4"]}
    quick_arguments = [word for option, sizes in few.items() for word in (option, *sizes)]
    return growth.tables(growth.arguments(quick_arguments if options.quick else []))


def _memory(options: argparse.Namespace) -> list:
    argv = [str(path) for path in options.rigs]
    if options.quick:
        argv = argv or [str(ROOT / "assets" / f"{name}.glb") for name in ("biped", "robot")]
        argv += ["--resolution", "64"]
    return memory.tables(memory.arguments(argv))


PARTS = {"speed": _speed, "accuracy": _accuracy, "growth": _growth, "memory": _memory}
HEADINGS = {name: name.capitalize() for name in PARTS} | {"speed": "Speed beside peers"}


def main(argv: Sequence[str] | None = None) -> None:
    """Measure everything and write the report."""
    options = arguments(argv)
    date = datetime.date.today().isoformat()
    parts = [INTRODUCTION.format(date=date, machine=machine())]
    if options.quick:
        parts.append("**A quick run: few rigs, low resolutions, each once.**\n")
    for name in options.parts:
        measured = [table.markdown() for table in PARTS[name](options)]
        parts.append("\n\n".join([f"## {HEADINGS[name]}", *measured]) + "\n")
    write_all({options.out: "\n".join(parts).encode()})


if __name__ == "__main__":
    main()
