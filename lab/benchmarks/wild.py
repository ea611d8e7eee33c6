"""Measure our weights on all characters, with the joints of their makers and as fresh ones.

    python -m cutcell_lab.benchmarks.wild [SET...] [--resolution 64] [--out docs/quality.md]

Sets are rigs, wild and train, folders in ../shared/data; all three when none is named. A file's
weights tell which joints carry some: "known". A fresh character has no weights: then
`cutcell.deform_joints` guesses, "fresh". Both are compared with the file's weights, one vertex
for each place of the mesh; for the deformation error all joints of the skeleton are turned.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cutcell
from cutcell.errors import CutcellError
from cutcell.rig import Rig

from ..metrics import deformation_error, vertex_shares, weight_l1
from .document import fill
from .rigs import SHARED
from .tables import Table

SETS = ("rigs", "wild", "train")
ENDINGS = (".glb", ".gltf", ".npz")
SOME = 0.01
"""Smallest weight at which a vertex follows a joint."""
MODES = ("known", "fresh")


@dataclass(frozen=True)
class Score:
    """How near weights are to the file's own: L1, cm2, and joints that a vertex follows."""

    l1: float
    deformation: float
    influences: float


@dataclass(frozen=True)
class Result:
    """One character, bound both ways; `guessed` counts joints whose guess is not as known."""

    name: str
    vertices: int
    joints: int
    guessed: int
    scores: dict[str, Score]


def files_of(group: str) -> list[Path]:
    """List the characters of a set, in order."""
    return [path for path in sorted((SHARED / group).rglob("*")) if path.suffix in ENDINGS]


def measure(rig: Rig, name: str, resolution: int) -> Result:
    """Bind a character that has weights as known and as fresh, and compare both with them."""
    fresh = cutcell.choose_deform(rig, fresh=True)
    scores = {
        mode: score_of(rig, cutcell.bind(bound, resolution).weights)
        for mode, bound in zip(MODES, (rig, fresh), strict=True)
    }
    joints = rig.skeleton
    guessed = int((fresh.skeleton.deform != joints.deform).sum())
    return Result(name, len(rig.mesh.vertices), len(joints.joints), guessed, scores)


def score_of(rig: Rig, weights: np.ndarray) -> Score:
    """Compare weights with those that a rig has."""
    assert rig.weights is not None
    shares = vertex_shares(rig.mesh, "welded")
    error = deformation_error(rig, weights, rig.weights, joints="all")
    followed = (weights >= SOME).sum(axis=1) @ shares / shares.sum()
    return Score(weight_l1(weights, rig.weights, shares), error.mean, float(followed))


def characters(group: str) -> Iterator[tuple[str, Rig]]:
    """Load those of a set that have weights; reports why others are left out."""
    for path in files_of(group):
        # A glTF in parts is named by its folder: its document is often called scene.
        name = path.parent.name if path.suffix == ".gltf" else path.stem
        try:
            rig = cutcell.load(path)
        except CutcellError as error:
            print(f"{name}: {error}", flush=True)
            continue
        if rig.weights is None or not rig.weights.any():
            print(f"{name}: no weights to compare with", flush=True)
            continue
        yield name, rig


def results(group: str, resolution: int) -> Iterator[Result]:
    """Measure a set, telling of each character."""
    for name, rig in characters(group):
        result = measure(rig, name, resolution)
        by_makers, fresh = (result.scores[mode] for mode in MODES)
        print(
            f"{group} {name}: known {by_makers.l1:.3f} {by_makers.deformation:.2f}, "
            f"fresh {fresh.l1:.3f} {fresh.deformation:.2f}",
            flush=True,
        )
        yield result


def each_table(group: str, result: Sequence[Result]) -> Table:
    """List the characters of a set."""
    columns = ["character", "vertices", "joints", "guessed otherwise"]
    columns += [f"{mode} {what}" for mode in MODES for what in ("L1", "cm²", "joints")]
    table = Table(group, columns)
    for one in result:
        table.add(
            one.name,
            f"{one.vertices:,}",
            one.joints,
            one.guessed,
            *(
                cell
                for mode in MODES
                for cell in (
                    f"{one.scores[mode].l1:.2f}",
                    f"{one.scores[mode].deformation:.2f}",
                    f"{one.scores[mode].influences:.1f}",
                )
            ),
        )
    return table


def summary(groups: dict[str, list[Result]]) -> Table:
    """Put medians, means and the worst of all sets together."""
    columns = ["set", "characters", "joints", "L1 median", "L1 mean"]
    columns += ["cm² median", "cm² mean", "cm² worst", "joints of a vertex"]
    table = Table("All sets", columns)
    for group, result in groups.items():
        for mode in MODES:
            l1, deformation, influences = np.array(
                [(s.l1, s.deformation, s.influences) for s in (one.scores[mode] for one in result)]
            ).T
            table.add(
                group,
                len(result),
                mode,
                f"{np.median(l1):.3f}",
                f"{l1.mean():.3f}",
                f"{np.median(deformation):.2f}",
                f"{deformation.mean():.2f}",
                f"{deformation.max():.1f}",
                f"{influences.mean():.2f}",
            )
    return table


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sets", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--out", type=Path, help="a document whose tables to replace")
    options = parser.parse_args(arguments)
    if unknown := [name for name in options.sets if name not in SETS]:
        parser.error(f"no set {unknown[0]}; there are {', '.join(SETS)}")
    groups = {group: list(results(group, options.resolution)) for group in options.sets or SETS}
    groups = {group: result for group, result in groups.items() if result}
    if not groups:
        parser.error(f"no characters in {SHARED}")
    tables = {group: each_table(group, result).markdown() for group, result in groups.items()}
    overall = summary(groups).markdown()
    print("\n\n".join([overall, *tables.values()]))
    if options.out:  # of the train set, which is long and by one maker, only the summary
        listed = [text for group, text in tables.items() if group != "train"]
        fill(options.out, {"wild": "\n\n".join([overall, *listed])})


if __name__ == "__main__":
    main()
