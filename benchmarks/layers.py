"""How long a stack of layers takes over the weights of a large character.

python -m benchmarks.layers [--vertices 300000] [--joints 200] [--rounds 3]

Each vertex has weights of four joints. The time on the processor does not depend on what else the
machine does.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import cutcell
from cutcell.editing.layers import apply_layers
from cutcell.editing.layers.sources import RigSources
from cutcell_lab.benchmarks.tables import Table, seconds

from .page_subjects import character
from .report import circumstances

INFLUENCES = 4


def painted_character(vertices: int, joints: int) -> cutcell.Rig:
    """Make a character whose vertices follow their nearest joints, as its file's weights."""
    rig = character(vertices, joints)
    points = rig.mesh.vertices
    gap, near = cKDTree(rig.skeleton.joints).query(points, k=INFLUENCES)
    weights = np.zeros((len(points), len(rig.skeleton.joints)))
    np.put_along_axis(weights, near, 1 / (gap + 0.01), axis=1)
    return rig.with_weights(weights / weights.sum(axis=1, keepdims=True))


def stack(rig: cutcell.Rig) -> list[cutcell.Layer]:
    """Return layers as a person makes them, from bottom to top."""
    order, names = np.argsort(rig.mesh.vertices[:, 1]), rig.skeleton.names

    def region(start: float, size: int) -> NDArray[np.intp]:
        first = int(start * len(order))
        return np.sort(order[first : first + size])

    count = len(order)
    rows = np.random.default_rng(1).random((len(region(0.5, 20_000)), INFLUENCES))
    return [
        cutcell.Layer(cutcell.Painted(region(0.5, 20_000), names[3:7], rows)),
        cutcell.Layer(cutcell.Filled({names[5]: 1}), cutcell.Mask(vertices=region(0.9, 20_000))),
        cutcell.Layer(cutcell.FromFile(), cutcell.Mask(vertices=region(0.2, count // 5)), "", 0.5),
        cutcell.Layer(cutcell.Smoothed(4), cutcell.Mask(vertices=region(0.3, count // 20))),
        cutcell.Layer(cutcell.Locked(names[2:5])),
    ]


def layers_table(rig: cutcell.Rig, rounds: int) -> Table:
    """Apply the stack; give the quickest of some rounds, layer by layer."""
    assert rig.weights is not None
    base, layers = np.roll(rig.weights, 1, axis=1), stack(rig)
    taken = np.array([_seconds(rig, base, layers) for _ in range(rounds + 1)])
    first, best = taken[0], taken[1:].min(axis=0)
    table = Table(
        "A stack of layers",
        ["layer", "seconds", "on the processor", "the first time"],
        f"{len(base):,} vertices, {base.shape[1]} joints, the quickest of {rounds}. "
        + circumstances(),
    )
    for layer, (wall, processor), (start, _) in zip(layers, best, first, strict=True):
        table.add(layer.title, seconds(wall), seconds(processor), seconds(start))
    table.add("**all**", *map(seconds, (*best.sum(axis=0), first[:, 0].sum())))
    return table


def _seconds(
    rig: cutcell.Rig, base: NDArray[np.float64], layers: list[cutcell.Layer]
) -> NDArray[np.float64]:
    """Return the seconds of each layer, by the clock and on the processor: shape (layers, 2)."""
    clock = [(perf_counter(), process_time())]

    def note(layer: cutcell.Layer, weights: NDArray[np.float64]) -> None:
        clock.append((perf_counter(), process_time()))

    apply_layers(base, layers, RigSources(rig, cutcell.ANIMATION), note)
    return np.diff(np.array(clock), axis=0)


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.layers", description=__doc__)
    parser.add_argument("--vertices", type=int, default=300_000)
    parser.add_argument("--joints", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args(argv)
    rig = painted_character(options.vertices, options.joints)
    print(layers_table(rig, options.rounds).markdown())


if __name__ == "__main__":
    main()
