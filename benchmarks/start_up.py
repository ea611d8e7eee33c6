"""How long a new process takes until cutcell is there, and until it has bound a rig."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from time import perf_counter

from .rigs import ROOT, Character
from .tables import Table
from .timing import Times

NOTHING = "pass"
IMPORT = "import cutcell"
BIND = "import cutcell; cutcell.bind(cutcell.load('assets/biped.glb'), 32)"


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
        with tempfile.TemporaryDirectory() as folder:
            table.add("the same, first compile ever", Times((run(BIND, NUMBA_CACHE_DIR=folder),)))
    return table


def _times(code: str, options: argparse.Namespace) -> Times:
    return Times(tuple(run(code) for _ in range(options.repeats)))


def run(code: str, **environment: str) -> float:
    """Run Python code in a new process and return the seconds it took."""
    begin = perf_counter()
    subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        cwd=ROOT,
        env=os.environ | environment,
        check=True,
        capture_output=True,
    )
    return perf_counter() - begin
