"""Measure the weight that parts side by side share across the gap, on the demo characters.

    python -m cutcell_lab.benchmarks.crosstalk [--methods NAME,...] [--out docs/quality.md]

The artist's weights of these characters are made, not painted: they share nothing there.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.graph import build_graph
from cutcell_lab.baselines import METHODS, BaselineBinding
from cutcell_lab.baselines.methods import accepted_options

from ..metrics import crosstalk, find_gaps
from .document import fill
from .rigs import ROOT
from .tables import Table


@dataclass(frozen=True)
class Place:
    """Parts of a demo character that nearly touch.

    Parameters
    ----------
    name, demo : str
    near, far : float
        See `find_gaps`.
    resolution : int
        R that everything has there.
    """

    name: str
    demo: str
    near: float
    far: float
    resolution: int = 64


PLACES = (
    Place("fingers", "biped", 0.015, 0.05, 128),
    Place("arms and legs", "biped", 0.05, 0.25),
    Place("ears on a back", "rabbit", 0.05, 0.25),
    Place("curled arms", "octopus", 0.1, 0.25),
)


def gaps(place: Place, rig: cutcell.Rig) -> NDArray[np.int32]:
    """Find pairs of vertices across the gap; nearly straight paths say what is far."""
    graph = build_graph(rig.mesh, place.resolution, connectivity=26)
    return find_gaps(graph, near=place.near, far=place.far)


def bound(
    method: Callable[..., BaselineBinding], rig: cutcell.Rig, resolution: int
) -> BaselineBinding:
    """Bind with those options that a method accepts."""
    return method(rig, **accepted_options(method, resolution=resolution, max_influences=None))


def strongest(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Keep only the strongest joint of each vertex."""
    alone = np.zeros_like(weights)
    alone[np.arange(len(weights)), weights.argmax(axis=1)] = 1
    return alone


def crosstalk_table(methods: Sequence[str], places: Sequence[Place] = PLACES) -> Table:
    """Measure all: each cell with every joint that a method likes, and with the nearest alone."""
    table = Table(
        "Crosstalk on the demo characters",
        ["method", *(f"{place.name} ({place.demo})" for place in places)],
        "Weight that both sides of a gap give to the same joints, of 1: with all the joints that "
        "a vertex follows / with its strongest joint alone. The artist's is 0.",
    )
    rows: dict[str, list[str]] = {name: [] for name in methods}
    for place in places:
        rig = cutcell.load(ROOT / "assets" / f"{place.demo}.glb")
        pairs = gaps(place, rig)
        for name in methods:
            weights = bound(METHODS[name], rig, place.resolution).weights
            if weights is None:
                rows[name].append("failed")
            else:
                both = (crosstalk(w, pairs).mean for w in (weights, strongest(weights)))
                rows[name].append(" / ".join(f"{value:.3f}" for value in both))
            print(f"{place.name}: {name}: {rows[name][-1]}", file=sys.stderr, flush=True)
    for name, cells in rows.items():
        table.add(name, *cells)
    return table


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print or write."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.crosstalk", description=__doc__
    )
    parser.add_argument("--methods", help="names with commas between; all when left out")
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    names = options.methods.split(",") if options.methods else sorted(set(METHODS) - {"artist"})
    if unknown := [name for name in names if name not in METHODS]:
        sys.exit(f"unknown: {', '.join(unknown)}; known: {', '.join(METHODS)}")
    text = crosstalk_table(names).markdown()
    print(text)
    if options.out:
        fill(options.out, {"crosstalk": text})


if __name__ == "__main__":
    main()
