"""Compare what `Binding.stretch` marks with the deformation error, which needs an artist's weights.

    python -m cutcell_lab.benchmarks.stretch [SET...] [--out docs/quality.md]

Characters are bound with the deforming joints of the file ("known") and with guessed ones
("fresh"). Their artists' own weights are measured, too.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

import cutcell
from cutcell.pose.stretch import MAX_SHARE, measure_stretch
from cutcell.rig import Rig

from .document import fill
from .tables import Table
from .wild import MODES, characters, score_of

GROUPS = ("rigs", "wild", "more")
BAD, GOOD = 20.0, 1.0
"""Deformation errors in cm2 above and below which weights are bad and good."""


class Marked(NamedTuple):
    """One character bound one way, or as its artist did, which has no error."""

    name: str
    weights: str
    error: float
    share: float


def marks(name: str, rig: Rig) -> Iterator[Marked]:
    """Bind a character that has weights both ways, and measure all three."""
    assert rig.weights is not None
    graph = None
    for mode, bound in zip(MODES, (rig, cutcell.choose_deform(rig, fresh=True)), strict=True):
        binding = cutcell.bind(bound)
        graph = binding.graph
        yield Marked(name, mode, score_of(rig, binding.weights).deformation, binding.stretch.share)
    assert graph is not None
    stretch = measure_stretch(graph, rig.skeleton, rig.weights)
    yield Marked(name, "artists'", 0.0, stretch.share)


def marks_table(rows: Sequence[Marked]) -> Table:
    """Count the characters that are marked, among all, bad and good ones."""
    columns = ["weights", "characters", "marked", f"over {BAD:g} cm²", "marked of these"]
    columns += [f"below {GOOD:g} cm²", "marked of these "]
    note = f"Marked: more than {MAX_SHARE:.0%} of the surface stretches."
    table = Table("Weights that stretch", columns, note)
    for kind in (*MODES, "artists'"):
        error, share = np.array([(r.error, r.share) for r in rows if r.weights == kind]).T
        is_marked = share > MAX_SHARE
        parts: list[int | str] = ["-"] * 4
        if kind in MODES:
            parts = [
                int(which.sum())
                for bad in (error > BAD, error < GOOD)
                for which in (bad, bad & is_marked)
            ]
        table.add(kind, len(error), int(is_marked.sum()), *parts)
    return table


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("sets", nargs="*", metavar="SET", help="folders of characters")
    parser.add_argument("--out", type=Path, help="a document whose table to replace")
    options = parser.parse_args(arguments)
    rows = [
        mark
        for group in options.sets or GROUPS
        for name, rig in characters(group)
        for mark in marks(name, rig)
    ]
    text = marks_table(rows).markdown()
    print(text)
    if options.out:
        fill(options.out, {"stretch": text})


if __name__ == "__main__":
    main()
