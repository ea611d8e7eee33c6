"""Effects of `cutcell.clean` on damaged weights, on those of other methods and of artists.

    python -m cutcell_lab.benchmarks.clean [SET...] [--resolution 64] [--near 2 3] [--out FILE]

Sets are rigs, wild and train, folders in ../shared/data. Weights by artists are the truth: they
are damaged in known ways, replaced by those of other methods, and cleaned as they are.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.diagnosis import cleaning
from cutcell.rig import Rig
from cutcell_lab.baselines import METHODS

from ..metrics import deformation_error, find_gaps, vertex_shares, weight_l1
from .document import fill
from .rigs import SHARED
from .tables import Table
from .wild import SETS, characters

LEAKED, NOISE = 0.4, 0.3
"""Share of a vertex's weight that leaks across a gap, and that noise gives to another joint."""
NOISY = 0.1
"""Share of noisy vertices."""
ISLANDS, ISLAND = 3, 0.02
"""How many islands there are, and which part of the vertices each takes."""
ALLOWED = 0.01
"""An artist's weights shall not change by as much, L1."""
SEED = 19


def leaked(rig: Rig, resolution: int) -> NDArray[np.float64] | None:
    """Mix weights across gaps; None where the body has none."""
    gaps = find_gaps(cutcell.build_graph(rig.mesh, resolution, connectivity=6))
    if not len(gaps):
        return None
    weights = _weights(rig).copy()
    for one_side, other_side in (gaps.T, gaps.T[::-1]):
        vertex, first = np.unique(one_side, return_index=True)
        mixed = (1 - LEAKED) * _weights(rig)[vertex] + LEAKED * _weights(rig)[other_side[first]]
        weights[vertex] = mixed
    return weights


def noisy(rig: Rig, resolution: int) -> NDArray[np.float64]:
    """Give the weight of random vertices to random joints."""
    rng = np.random.default_rng(SEED)
    weights = _weights(rig).copy()
    chosen = np.flatnonzero(rng.random(len(weights)) < NOISY)
    weights[chosen] *= 1 - NOISE
    weights[chosen, rng.choice(_carrying(rig), len(chosen))] += NOISE
    return weights


def with_islands(rig: Rig, resolution: int) -> NDArray[np.float64] | None:
    """Give patches to a joint of the farther half that no vertex of the patch follows."""
    rng = np.random.default_rng(SEED)
    vertices, weights = rig.mesh.vertices, _weights(rig).copy()
    carrying, used = _carrying(rig), rig.mesh.used
    size = max(4, int(ISLAND * len(used)))
    dropped = 0
    for _ in range(ISLANDS):
        middle = vertices[rng.choice(used)]
        patch = used[np.argsort(np.linalg.norm(vertices[used] - middle, axis=1))[:size]]
        away = np.linalg.norm(rig.skeleton.joints[carrying] - middle, axis=1)
        far = carrying[away >= np.median(away)]
        far = far[~(_weights(rig)[np.ix_(patch, far)] > 0).any(axis=0)]
        if len(far):
            weights[patch] = np.eye(weights.shape[1])[rng.choice(far)]
            dropped += 1
    return weights if dropped else None


def by_voxels(rig: Rig, resolution: int) -> NDArray[np.float64] | None:
    """Return the weights of geodesic voxel binding."""
    return METHODS["voxel"](rig, resolution=resolution).weights


def by_straight_lines(rig: Rig, resolution: int) -> NDArray[np.float64] | None:
    """Return weights by straight distances."""
    return METHODS["euclidean"](rig).weights


Make = Callable[[Rig, int], NDArray[np.float64] | None]
KINDS: dict[str, Make] = {
    "leaked across gaps": leaked,
    "noise": noisy,
    "islands": with_islands,
    "voxel": by_voxels,
    "euclidean": by_straight_lines,
}
DAMAGES = ("leaked across gaps", "noise", "islands")


@dataclass
class Cleaned:
    """One character: the change of the artist's own weights, and errors before and after."""

    name: str
    changed: float
    moved: float
    errors: dict[str, tuple[float, float, float, float]] = field(default_factory=dict)


def measure(rig: Rig, name: str, resolution: int, kinds: Sequence[str]) -> Cleaned:
    """Clean all weights of a character."""
    truth, shares = _weights(rig), vertex_shares(rig.mesh)

    def errors(weights: NDArray[np.float64]) -> tuple[float, float]:
        return weight_l1(weights, truth, shares), deformation_error(rig, weights, truth).mean

    results = Cleaned(name, *errors(cutcell.clean(rig, resolution).weights))
    for kind in kinds:
        weights = KINDS[kind](rig, resolution)
        if weights is not None:
            cleaned = cutcell.clean(rig.with_weights(weights), resolution).weights
            results.errors[kind] = (*errors(weights), *errors(cleaned))
    return results


def own_table(groups: dict[str, list[Cleaned]]) -> Table:
    """Report the change of weights by artists."""
    columns = ["set", "characters", "unchanged", "L1 median", "L1 worst", "cm² worst", "worst"]
    note = f"The change of weights by artists; the limit is {ALLOWED} in L1."
    table = Table("Weights by artists, cleaned", columns, note)
    for group, results in groups.items():
        worst = max(results, key=lambda one: one.changed)
        table.add(
            group,
            len(results),
            sum(one.changed == 0 for one in results),
            f"{np.median([one.changed for one in results]):.4f}",
            f"{worst.changed:.4f}",
            f"{max(one.moved for one in results):.3f}",
            worst.name,
        )
    return table


def error_table(groups: dict[str, list[Cleaned]]) -> Table:
    """Say what cleaning does to each kind of weights."""
    columns = [
        "set",
        "weights",
        "characters",
        "L1 before",
        "L1 after",
        "cm² before",
        "cm² after",
        "worse",
    ]
    note = (
        "Means over the characters, against weights by artists; `worse`: characters whose L1 "
        "grew. Leaks: 40 % of the weight of vertices on either side of a gap is the other side's. "
        "Noise: a tenth of the vertices give 30 % to a random joint. Islands: three "
        "patches of 2 % of the vertices follow a joint elsewhere."
    )
    table = Table("Weights before and after", columns, note)
    for group, results in groups.items():
        for kind in KINDS:
            rows = np.array([one.errors[kind] for one in results if kind in one.errors])
            if len(rows):
                l1, moved, l1_after, moved_after = rows.mean(axis=0)
                table.add(
                    group,
                    kind,
                    len(rows),
                    f"{l1:.3f}",
                    f"{l1_after:.3f}",
                    f"{moved:.2f}",
                    f"{moved_after:.2f}",
                    int((rows[:, 2] > rows[:, 0] + 1e-9).sum()),
                )
    return table


def each_table(groups: dict[str, list[Cleaned]]) -> Table:
    """List the characters."""
    columns = ["character", "own", *KINDS]
    note = "L1: the change of the artist's own weights; of the others before and after."
    table = Table("Each character", columns, note)
    for results in groups.values():
        for one in results:
            cells = []
            for kind in KINDS:
                errors = one.errors.get(kind)
                cells.append("-" if errors is None else f"{errors[0]:.3f}, {errors[2]:.3f}")
            table.add(one.name, f"{one.changed:.4f}", *cells)
    return table


def near_table(rigs: dict[str, Rig], nears: Sequence[float], resolution: int) -> Table:
    """Say what other limits of what is near do."""
    columns = ["near", "own, worst L1", "worst", f"own over {ALLOWED}", *DAMAGES]
    note = (
        "A joint is near a vertex within this many times the distance of the nearest joint "
        f"({cleaning.NEAR_RATIO:g} by default). Of damaged weights the mean L1 after; rigs and "
        "wild."
    )
    table = Table("What is near", columns, note)
    default = cleaning.NEAR_RATIO
    for near in nears:
        cleaning.NEAR_RATIO = near
        results = [measure(rig, name, resolution, DAMAGES) for name, rig in rigs.items()]
        worst = max(results, key=lambda one: one.changed)
        after = [
            np.mean([one.errors[kind][2] for one in results if kind in one.errors] or [np.nan])
            for kind in DAMAGES
        ]
        over = sum(one.changed >= ALLOWED for one in results)
        table.add(
            f"{near:g}",
            f"{worst.changed:.4f}",
            worst.name,
            over,
            *(f"{value:.4f}" for value in after),
        )
        print(f"near {near:g}", flush=True)
    cleaning.NEAR_RATIO = default
    return table


def _weights(rig: Rig) -> NDArray[np.float64]:
    assert rig.weights is not None
    return rig.weights


def _carrying(rig: Rig) -> NDArray[np.intp]:
    return np.flatnonzero(_weights(rig).any(axis=0))


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.clean", description=__doc__
    )
    parser.add_argument("sets", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--near", nargs="*", type=float, default=[2, 2.5, 3, 4, 6])
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    if unknown := [name for name in options.sets if name not in SETS]:
        parser.error(f"no set {unknown[0]}; there are {', '.join(SETS)}")
    groups: dict[str, list[Cleaned]] = {}
    rigs: dict[str, Rig] = {}
    for group in options.sets or SETS:
        for name, rig in characters(group):
            results = measure(rig, name, options.resolution, list(KINDS))
            groups.setdefault(group, []).append(results)
            if group != "train":
                rigs[name] = rig
            print(f"{group} {name}: {results.changed:.4f}", flush=True)
    if not groups:
        parser.error(f"no characters in {SHARED}")
    listed = {group: results for group, results in groups.items() if group != "train"}
    tables = [own_table(groups), error_table(groups)]
    if options.near and rigs:
        tables.append(near_table(rigs, options.near, options.resolution))
    if listed:
        tables.append(each_table(listed))
    text = "\n\n".join(table.markdown() for table in tables)
    print(text)
    if options.out:
        fill(options.out, {"clean": text})


if __name__ == "__main__":
    main()
