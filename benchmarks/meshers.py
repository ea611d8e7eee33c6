"""Volume meshers beside the graph: each in a subprocess, with a time limit."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from cutcell.graph import build_graph
from cutcell_lab.benchmarks.rigs import Character
from cutcell_lab.benchmarks.tables import Table, seconds

from .mesher import MESHERS
from .stages import prepare
from .timing import in_turn

SCRIPT = Path(__file__).with_name("mesher.py")


def meshers_table(characters: list[Character], options: argparse.Namespace) -> Table:
    """Time tetrahedral meshers, once each, beside the graph at R = 64."""
    table = Table(
        "Volume meshers",
        ["rig", "cutcell graph, R=64", *MESHERS],
        "Filling the welded mesh with tetrahedra, once, in a subprocess, start not "
        "counted; fTetWild at its default edge length, TetGen without quality demands.",
    )
    for character in characters:
        mesh = character.rig.mesh
        graph_seconds = in_turn(
            {"graph": lambda m=mesh: build_graph(m, 64, connectivity=6)}, options.repeats
        )["graph"]
        cells = [run_mesher(name, character, options) for name in MESHERS]
        table.add(character.name, graph_seconds, *cells)
        print(f"{table.title}: {character.name}", file=sys.stderr, flush=True)
    return table


def run_mesher(library: str, character: Character, options: argparse.Namespace) -> str:
    """Run one mesher on one rig and put into words what came of it."""
    result = attempt(library, character, options.mesher_python, options.mesher_limit)
    if isinstance(result, str):
        return result
    return f"{seconds(result['seconds'])} ({result['cells']:,} tets)"


def attempt(
    library: str, character: Character, python: str, limit: float, edge: float | None = None
) -> dict | str:
    """Run one mesher on one rig: seconds and number of cells, or why there are none."""
    mesh = prepare(character.rig.mesh, 64).mesh
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.npz"
        np.savez(path, vertices=mesh.points, faces=mesh.faces)
        command = [
            os.path.abspath(python),
            str(SCRIPT),
            library,
            str(path),
            *([str(edge)] if edge else []),
        ]
        try:
            done = subprocess.run(
                command, cwd=folder, capture_output=True, text=True, timeout=limit
            )
        except subprocess.TimeoutExpired:
            return f"over {limit:g} s"
    if done.returncode < 0:
        return f"crashed (signal {-done.returncode})"
    lines = [line for line in done.stdout.splitlines() if line.startswith('{"')]
    if done.returncode or not lines:
        return "failed"
    result = json.loads(lines[-1])
    if "missing" in result:
        return "not installed"
    return result
