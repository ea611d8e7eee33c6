"""How long a new process takes until cutcell is there, and until it has bound a rig."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from cutcell_lab.benchmarks.rigs import ROOT, Character
from cutcell_lab.benchmarks.tables import Table

from .timing import Times

NOTHING = "pass"
IMPORT = "import cutcell"
BIND = f"import cutcell; cutcell.bind(cutcell.load({str(ROOT / 'assets' / 'biped.glb')!r}), 32)"


def start_up_table(characters: list[Character], options: argparse.Namespace) -> Table:
    """Time new processes: an empty one, one that imports cutcell, one that binds."""
    table = Table(
        "Start-up",
        ["new process", "wall time"],
        "Kernels are compiled once and kept on disk; a second process finds them there.",
    )
    run(BIND)  # compile whatever has not been
    table.add("python alone", _times(NOTHING, options))
    table.add("python, import cutcell", _times(IMPORT, options))
    table.add("python, import cutcell, load and bind the demo at R=32", _times(BIND, options))
    if options.cold:
        table.add("the same, first compile ever", Times((first_compile(),)))
    return table


def first_compile() -> float:
    """Bind by a copy of the package that finds nothing compiled: not beside itself, nor at home."""
    with tempfile.TemporaryDirectory() as folder:
        without = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "cutcell", Path(folder, "cutcell"), ignore=without)
        places = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "LOCALAPPDATA"), folder)
        return run(BIND, Path(folder), **places, NUMBA_CACHE_DIR=folder, PYTHONPATH="")


def _times(code: str, options: argparse.Namespace) -> Times:
    return Times(tuple(run(code) for _ in range(options.repeats)))


def run(code: str, folder: Path = ROOT, **environment: str) -> float:
    """Run Python code in a new process, in a folder; return the seconds it took."""
    begin = perf_counter()
    subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        cwd=folder,
        env=os.environ | environment,
        check=True,
        capture_output=True,
    )
    return perf_counter() - begin
