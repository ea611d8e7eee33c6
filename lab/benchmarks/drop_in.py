"""Measure `cutcell.priors.voxel_skin` beside voxels as UniRig and SkinTokens compute them.

    python -m cutcell_lab.benchmarks.drop_in [--count 200] [--voxels 196] [--out docs/networks.md]

A network's weights are stood in for by an artist's, damaged in three ways by three strengths. They
are multiplied by each prior and normalised, as SkinTokens' `demo.py` does with its own.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import cutcell
from cutcell import Rig
from cutcell.errors import CutcellError
from cutcell.priors import LEAST_DISTANCE, voxel_skin
from cutcell.weights.paper_kernel import paper_kernel

from ..baselines.body import Body
from ..baselines.volumes.voxel_binding import UNIRIG_VOXEL_COST, path_lengths
from ..baselines.volumes.voxels import voxelize
from ..metrics import crosstalk, find_gaps, vertex_shares, weight_l1
from .document import fill
from .rigs import ROOT
from .tables import Table, seconds
from .wild import files_of

SETS = ("rigs", "wild", "train", "more")
QUERY = 27
"""Neighbours that the original asks its trees for: a voxel and the 26 around it."""
REACH = 1.74
"""Voxels that its links reach: a little more than the diagonal of one."""
NEAREST = 3
SIDE = 2.0
"""Longest side of a mesh in the original's units."""
STRENGTHS = (0.1, 0.3, 0.5)
BLUR = {0.1: 4, 0.3: 16, 0.5: 64}
"""Neighbours in space that a blur of each strength averages."""
TIMED = 20
"""Characters of which time and memory are measured, each in a process of its own."""


def voxel_prior(rig: Rig, resolution: int) -> NDArray[np.float64]:
    """Compute the prior of UniRig and SkinTokens with joints as points, (n, j).

    It reads `voxel_skin` with its defaults: 27 neighbours, links within 1.74 voxels, steps between
    voxels three times as long, unreached vertices straight to three joints.
    """
    body = Body.of(rig, resolution=resolution)
    voxels = voxelize(body, fill="spans")
    points, count = body.points, len(body.points)
    links, lengths = voxels.links()
    away, near = cKDTree(points).query(voxels.centres, k=min(QUERY, count))
    voxel, column = np.nonzero(away < REACH / resolution)
    nodes = np.concatenate([points, voxels.centres])
    at = body.lattice.to_unit(rig.skeleton.joints)
    distance = path_lengths(
        len(nodes),
        np.concatenate(
            [links + count, body.mesh.edges.edges,
             np.stack([near[voxel, column], voxel + count], axis=1)]
        ),
        np.concatenate(
            [UNIRIG_VOXEL_COST * lengths, body.mesh.edge_lengths, away[voxel, column]]
        ),
        cKDTree(nodes).query(at)[1][:, None],
    )[:, :count]  # fmt: skip
    lost = np.flatnonzero(~np.isfinite(distance).any(axis=0))
    straight, which = cKDTree(at).query(points[lost], k=range(1, min(NEAREST, len(at)) + 1))
    distance[which, lost[:, None]] = straight
    distance[~np.isfinite(distance)] = distance[np.isfinite(distance)].max()
    return paper_kernel(np.maximum(SIDE * distance, LEAST_DISTANCE), 1.0, 0.5)[body.index]


def cutcell_prior(rig: Rig, resolution: int) -> NDArray[np.floating]:
    """Compute the drop-in's prior, (n, j), of joints as points."""
    return _drop_in(rig, resolution, None)


def cutcell_bones(rig: Rig, resolution: int) -> NDArray[np.floating]:
    """Compute the drop-in's prior, (n, j), of bones."""
    return _drop_in(rig, resolution, rig.skeleton.parents)


def _drop_in(rig: Rig, resolution: int, parents: NDArray | None) -> NDArray[np.floating]:
    low, high = rig.mesh.bounds
    centre, half = (low + high) / 2, (high - low).max() / 2
    return voxel_skin(
        joints=(rig.skeleton.joints - centre) / half,
        vertices=(rig.mesh.vertices - centre) / half,
        faces=rig.mesh.faces,
        parents=parents,
        method=cutcell.PAPER.with_options(resolution=resolution),
    )


def noise(rig: Rig, weights: NDArray, strength: float, rng: np.random.Generator) -> NDArray:
    """Mix random weights of all joints in."""
    drawn = rng.exponential(size=weights.shape)
    return (1 - strength) * weights + strength * drawn / drawn.sum(axis=1, keepdims=True)


def leaks(rig: Rig, weights: NDArray, strength: float, rng: np.random.Generator) -> NDArray:
    """Give ten patches of a fiftieth of the vertices a share of a joint drawn at random."""
    leaked, tree = weights.copy(), cKDTree(rig.mesh.vertices)
    for _ in range(10):
        centre = rig.mesh.vertices[rng.integers(len(weights))]
        patch = tree.query(centre, k=max(len(weights) // 50, 2))[1]
        leaked[patch] *= 1 - strength
        leaked[patch, rng.integers(weights.shape[1])] += strength
    return leaked


def blur(rig: Rig, weights: NDArray, strength: float, rng: np.random.Generator) -> NDArray:
    """Average over neighbours in space, across gaps, too."""
    near = cKDTree(rig.mesh.vertices).query(rig.mesh.vertices, k=BLUR[strength] + 1)[1]
    return weights[np.minimum(near, len(weights) - 1)].mean(axis=1)


DAMAGES: dict[str, Callable[[Rig, NDArray, float, np.random.Generator], NDArray]] = {
    "noise": noise,
    "leaks": leaks,
    "blur": blur,
}


@dataclass(frozen=True)
class Score:
    """L1 and crosstalk of one character by (damage, strength, prior); nan without a gap."""

    name: str
    l1: dict[tuple[str, float, str], float]
    across: dict[tuple[str, float, str], float]


def score(name: str, rig: Rig, resolution: int, voxels: int) -> Score:
    """Damage an artist's weights, correct them by each prior, and compare."""
    artist = np.asarray(rig.weights, np.float64)
    priors = {
        "alone": np.ones_like(artist),
        "voxels": voxel_prior(rig, voxels),
        "cut-cell": cutcell_prior(rig, resolution),
        "cut-cell, bones": cutcell_bones(rig, resolution),
    }
    pairs = find_gaps(cutcell.build_graph(rig.mesh, 64, connectivity=26))
    shares, rng = vertex_shares(rig.mesh), np.random.default_rng(0)
    l1, across = {}, {}
    for damage, spoil in DAMAGES.items():
        for strength in STRENGTHS:
            damaged = spoil(rig, artist, strength, rng)
            for prior, values in priors.items():
                product = damaged * values
                product /= product.sum(axis=1, keepdims=True)
                key = damage, strength, prior
                l1[key] = float(weight_l1(product, artist, shares))
                across[key] = float(crosstalk(product, pairs).mean)
    return Score(name, l1, across)


def characters(count: int) -> list[tuple[str, Path]]:
    """Choose characters evenly from all sets."""
    paths = [(path.stem, path) for group in SETS for path in files_of(group)]
    step = max(len(paths) / count, 1)
    return [paths[int(k * step)] for k in range(min(count, len(paths)))]


def with_weights(path: Path) -> Rig | None:
    """Load a character that an artist gave weights; its joints are those that carry some."""
    try:
        rig = cutcell.load(path)
    except CutcellError:
        return None
    if rig.weights is None or not rig.weights.any() or not len(rig.skeleton.joints):
        return None
    used = np.flatnonzero(rig.weights.any(axis=0))
    if len(used) < 2 or not (rig.weights.sum(axis=1) > 0).all():
        return None
    return rig


def cost(task: tuple[Path, str, int]) -> tuple[float, float]:
    """Measure seconds, and megabytes beyond those of the loaded character, in this process."""
    path, side, resolution = task
    compute = {"voxels": voxel_prior, "cut-cell": cutcell_prior}[side]
    compute(cutcell.load(ROOT / "assets" / "biped.glb"), 8)  # what is compiled once
    rig = cutcell.load(path)
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before, start = _resident("VmRSS"), time.perf_counter()
    compute(rig, resolution)
    return time.perf_counter() - start, _resident("VmHWM") - before


def _resident(entry: str) -> float:
    """Read the memory that this process holds, or held at most, in megabytes (Linux)."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith(entry)).split()[1]) / 1024


def damage_table(scores: Sequence[Score], measure: str, title: str) -> Table:
    """Compare medians over the characters, for each damage and strength."""
    names = ("alone", "voxels", "cut-cell", "cut-cell, bones")
    table = Table(
        title,
        ["damage", "strength", *names, "better : worse"],
        "Medians of the damaged weights alone and times each prior. The last column counts "
        "characters that are better, and worse, with cut cells than with voxels, both from joints "
        "as points.",
    )
    for damage in DAMAGES:
        for strength in STRENGTHS:
            every = [getattr(one, measure) for one in scores]
            values = {
                name: np.array([one[damage, strength, name] for one in every]) for name in names
            }
            gain = values["voxels"] - values["cut-cell"]
            gain = gain[np.isfinite(gain)]
            medians = [_median(values[name]) for name in names]
            table.add(damage, strength, *medians, f"{(gain > 0).sum()} : {(gain < 0).sum()}")
    return table


def _median(values: NDArray[np.float64]) -> str:
    finite = values[np.isfinite(values)]
    return f"{np.median(finite):.3f}" if len(finite) else "-"


def worst_table(scores: Sequence[Score]) -> Table:
    """Name the characters on which cut cells lose most, over all damages."""
    table = Table(
        "Where the cut-cell prior is worse", ["character", "voxels", "cut-cell"],
        "Mean L1 over all damages, joints as points; the ten with the largest loss.",
    )  # fmt: skip
    means = [
        [
            float(np.mean([v for key, v in one.l1.items() if key[2] == name]))
            for name in ("voxels", "cut-cell")
        ]
        for one in scores
    ]
    order = np.argsort([their - our for their, our in means])[:10]
    for k in order:
        if means[k][1] > means[k][0]:
            table.add(scores[k].name, *(f"{value:.3f}" for value in means[k]))
    return table


def cost_table(paths: Sequence[Path], resolution: int, voxels: int) -> Table:
    """Measure time and memory, each in a process of its own."""
    table = Table(
        f"Time and memory, voxels at {voxels}, cut cells at {resolution}",
        ["prior", "median", "largest", "median memory", "largest memory"],
        f"{len(paths)} characters, each in a process of its own, without reading the file and "
        "without what is compiled once on a machine. Memory is what the process holds at most "
        "beyond the loaded character.",
    )
    with get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        for side, size in (("voxels", voxels), ("cut-cell", resolution)):
            measured = pool.map(cost, [(path, side, size) for path in paths], chunksize=1)
            spent, memory = np.array(measured).T
            times = (seconds(float(value)) for value in (np.median(spent), spent.max()))
            sizes = (f"{value:,.0f} MB" for value in (np.median(memory), memory.max()))
            table.add(side, *times, *sizes)
    return table


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(
        prog="python -m cutcell_lab.benchmarks.drop_in", description=__doc__
    )
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--voxels", type=int, default=196)
    parser.add_argument("--out", type=Path, help="a document with marks for it")
    options = parser.parse_args(argv)
    scores, timed = [], []
    for name, path in characters(options.count):
        rig = with_weights(path)
        if rig is None:
            print(f"{name} is left out: it has no weights to compare with", file=sys.stderr)
            continue
        scores.append(score(name, rig, options.resolution, options.voxels))
        timed.append(path)
        print(f"{len(scores)} {name}", file=sys.stderr, flush=True)
    step = max(len(timed) // TIMED, 1)
    tables = [
        damage_table(scores, "l1", f"L1 to the artist's weights, {len(scores)} characters"),
        damage_table(scores, "across", "Crosstalk, characters with a gap"),
        worst_table(scores),
        cost_table(timed[::step][:TIMED], options.resolution, options.voxels),
    ]
    text = "\n\n".join(table.markdown() for table in tables)
    print(text)
    if options.out:
        fill(options.out, {"drop-in": text})


if __name__ == "__main__":
    main()
