"""Whether a diagnosis names the fault of damaged rigs, and says nothing grave of sound ones.

python -m cutcell_lab.benchmarks.diagnosis [RIG ...] [--resolution R] [--markdown OUT]

Some rigs are damaged in each way of `damages.py`. A fault is detected if a finding of its code
is there that names at least half of the elements that were damaged.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import cutcell
from cutcell.diagnosis import Diagnosis

from .damages import DAMAGES, READING, Damaged
from .rigs import SHARED, rig_paths
from .tables import Table, publish

RIGS = ("kaykit_knight", "khronos_CesiumMan", "quaternius_wolf", "quaternius_wizard")
"""The real rigs that are damaged if none is named; demo characters where they are absent."""
DEMOS = ("octopus", "robot")
SEVERE = ("error", "warning")


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rigs", nargs="*", type=Path)
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--markdown", type=Path)
    options = parser.parse_args(arguments)
    paths = rig_paths(options.rigs)
    rigs = {path.stem: path for path in paths}
    chosen = list(rigs) if options.rigs else [n for n in RIGS if n in rigs] or list(DEMOS)
    wild = [] if options.rigs else wild_paths()
    damaged = damaged_table([cutcell.load(rigs[name]) for name in chosen], options.resolution)
    publish([damaged, sound_table([*paths, *wild], options.resolution)], options.markdown)


def wild_paths() -> list[Path]:
    """Return characters as many makers wrote them, where they are at hand."""
    folder = SHARED / "wild"
    return sorted(p for p in folder.rglob("*") if p.suffix in (".glb", ".gltf", ".npz"))


def damaged_table(rigs: Sequence[cutcell.Rig], resolution: int) -> Table:
    """Return which damage is found in which rig."""
    columns = ("damage", "code", *(rig.name for rig in rigs))
    note = (
        "The severity of the finding that names the damage, or what was missed; behind it other "
        "errors and warnings that the sound rig does not have."
    )
    table = Table("Damaged copies", columns, note)
    before = {rig.name: cutcell.diagnose(rig, resolution) for rig in rigs}
    detected = total = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, (code, damage) in DAMAGES.items():
            cells = []
            for rig in rigs:
                more = (Path(folder),) if damage in READING else ()
                damaged = damage(rig, 7, *more)
                after = cutcell.diagnose(damaged.rig, resolution)
                is_detected, cell = judge(code, damaged, before[rig.name], after)
                detected, total = detected + is_detected, total + 1
                cells.append(cell)
            table.add(name, code, *cells)
    table.add(f"**found: {detected} of {total}**", *[""] * (len(columns) - 1))
    return table


def judge(code: str, damaged: Damaged, before: Diagnosis, after: Diagnosis) -> tuple[bool, str]:
    """Return whether the damage was detected, and what a cell of the table says of it."""
    share = 0.0
    if code in after:
        named = getattr(after[code], damaged.kind)
        share = float(np.isin(damaged.elements, named).mean())
    is_detected = share >= 0.5
    severity = after[code].severity if code in after else ""
    cell = severity if is_detected else f"**missed** ({share:.0%})"
    expected = {f.code for f in before.findings if f.severity in SEVERE} | {code}
    others = [f.code for f in after.findings if f.severity in SEVERE and f.code not in expected]
    return is_detected, ", ".join([cell, *others])


def sound_table(paths: Sequence[Path], resolution: int) -> Table:
    """Return what is said of rigs as they are, and how long it takes."""
    columns = ("rig", "vertices", "errors", "warnings", "notes", "seconds", "with distances")
    note = "`with distances`: where these are known from a binding, as on the page."
    table = Table("Rigs as they are", columns, note)
    for path in paths:
        rig = cutcell.load(path)
        start = time.perf_counter()
        diagnosis = cutcell.diagnose(rig, resolution)
        spent = time.perf_counter() - start
        distances = cutcell.bind(rig, resolution=resolution).distances
        start = time.perf_counter()
        cutcell.diagnose(rig, distances=distances)
        again = time.perf_counter() - start
        name = path.stem if path.suffix != ".gltf" else path.parent.name
        severe = [", ".join(f.code for f in diagnosis.of(severity)) or "-" for severity in SEVERE]
        notes = len(diagnosis.of("note"))
        count = f"{len(rig.mesh.vertices):,}"
        table.add(name, count, *severe, notes, f"{spent:.2f}", f"{again:.2f}")
    return table


if __name__ == "__main__":
    main()
