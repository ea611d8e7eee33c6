"""Show where weights differ between two versions of the code, and whether they got better.

    python -m cutcell_lab.benchmarks.weight_changes record FOLDER [SET...] [--method M]
    python -m cutcell_lab.benchmarks.weight_changes compare OLD... NEW [--out docs/quality.md]

`record` binds all characters of the sets (demos, rigs, wild, more) with the joints of their makers
("known") and with their weights forgotten ("fresh"), and writes the weights into a folder; run it
in a checkout of each version. `compare` reads such folders, which name the versions: it prints each
version's scores beside those of the first, what differs between the first and the last, and
the worst characters.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.rig import Rig

from .document import fill
from .makers import maker_of
from .rigs import ROOT
from .tables import Table
from .wild import MODES, characters, score_of

SETS = ("demos", "rigs", "wild", "more")
"""The demos are not judged: their weights are made up."""
CHANGED = 0.01
"""A weight that differs by more than this has changed."""
LARGE = 20
"""Deformation error, in cm², of a character that failed."""
WORST = 10
"""Characters that are listed as the worst."""
CAUSES = {
    "bubba": "a body of parts, with joints in the gaps between them",
    "darby_ghost": "pelvis and spine share the cloth otherwise",
    "duznot_skeleton": "the spine takes shoulder blades, and the collar bones a part of the skull",
    "emoji_heart": "two joints are inside each other's component",
    "flock_lion": "its skull is a last joint in front of the muzzle, outside of the surface",
    "godot_enemy": "the legs take a part of its shell",
    "hiukim_bear": "a hand's cello follows the leg that it stands beside",
    "norah_frog": "head and throat are joints at one place",
    "picasty_goldfish": "the hub takes the part of the body that follows the spine",
    "quat_leela": "feet for inverse kinematics are at the ends of the shins",
    "quaternius_spider": "the front legs take a part of the head",
    "rukh_monarch": "small parts follow the root in the file, ours the spine that they touch",
    "space_survivor": "the pelvis has a joint on each side, whose skin thigh and spine take",
    "wu_knight": "a thumb takes the sword that it holds",
}
"""Why characters are among the worst, as far as somebody looked."""
NOTABLE = 0.03
"""A character is better or worse if its score changes by more than this part."""


@dataclass(frozen=True)
class Change:
    """Two bindings of one character: how many vertices changed, and scores before and after."""

    name: str
    mode: str
    vertices: float
    """Part of the vertices with a weight that changed."""
    largest: float
    """Largest change of a weight."""
    l1: tuple[float, float]
    deformation: tuple[float, float]
    """Deformation error, cm²."""
    cause: str


def rigs_of(group: str) -> Iterator[tuple[str, Rig]]:
    """Load the characters of a set."""
    if group != "demos":
        yield from characters(group)
        return
    for path in sorted((ROOT / "assets").glob("*.glb")):
        yield path.stem, cutcell.load(path)


def record(folder: Path, groups: Sequence[str], resolution: int, method: str) -> None:
    """Bind all characters of some sets and write weights, scores, joints and warnings."""
    for group in groups:
        for name, rig in rigs_of(group):
            for mode in MODES:
                bound = rig if mode == "known" else cutcell.choose_deform(rig, fresh=True)
                binding = cutcell.bind(bound, resolution, method=method)
                scores = np.full(2, np.nan)
                if rig.weights is not None and rig.weights.any():
                    score = score_of(rig, binding.weights)
                    scores = np.array([score.l1, score.deformation])
                path = folder / group / f"{name}.{mode}.npz"
                path.parent.mkdir(parents=True, exist_ok=True)
                np.savez_compressed(
                    path,
                    weights=binding.weights,
                    scores=scores,
                    joints=rig.skeleton.joints,
                    deform=bound.skeleton.deform,
                    warnings=np.array([*rig.warnings, *binding.warnings], dtype=str),
                )
                print(group, name, mode, *(f"{score:.3f}" for score in scores), flush=True)


def changes(old: Path, new: Path) -> Iterator[Change]:
    """Compare the recordings of one set, file by file."""
    for path in sorted(new.glob("*.npz")):
        name, mode = path.name.removesuffix(".npz").rsplit(".", 1)
        with np.load(old / path.name) as before, np.load(path) as after:
            if before["weights"].shape != after["weights"].shape:
                part = largest = 1.0
            else:
                part = changed_part(before["weights"], after["weights"])
                largest = float(np.abs(after["weights"] - before["weights"]).max())
            l1, deformation = zip(before["scores"], after["scores"], strict=True)
            yield Change(name, mode, part, largest, l1, deformation, cause_of(before, after))


def changed_part(before: NDArray, after: NDArray) -> float:
    """Return the part of the vertices (n,) with a changed weight, of two arrays (n, j)."""
    return float((np.abs(after - before).max(axis=1) > CHANGED).mean())


def cause_of(before, after) -> str:
    """Name what differs before weights are computed."""
    if before["joints"].shape != after["joints"].shape:
        return "other joints"
    size = np.ptp(before["joints"], axis=0).max()
    if np.abs(before["joints"] - after["joints"]).max() > 1e-3 * size:
        return "places of joints"
    if (before["deform"] != after["deform"]).any():
        return "deforming joints"
    return "bones and components"


def change_table(group: str, listed: Sequence[Change]) -> Table:
    """List the characters of a set whose weights changed notably, by their score."""
    columns = ["character", "joints", "vertices changed", "L1", "cm²", "differs first in"]
    table = Table(group, columns)
    for one in listed:
        before, after = one.deformation
        if abs(after - before) > NOTABLE * before:
            table.add(
                one.name,
                one.mode,
                f"{one.vertices:.1%}",
                "{:.3f} → {:.3f}".format(*one.l1),
                "{:.2f} → {:.2f}".format(*one.deformation),
                one.cause,
            )
    return table


def largest_changes(groups: dict[str, list[Change]]) -> Table:
    """Show the largest change of a weight in each set."""
    table = Table("Largest change of a weight", ["set", *MODES])
    for group, listed in groups.items():
        largest = [max(one.largest for one in listed if one.mode == mode) for mode in MODES]
        table.add(group, *(f"{change:.1g}" for change in largest))
    return table


def scores_of(folder: Path, mode: str) -> dict[str, NDArray[np.float64]]:
    """Read the scores (L1 and cm²) of the characters of one set that have weights, by name."""
    scores = {}
    for path in sorted(folder.glob(f"*.{mode}.npz")):
        with np.load(path) as recorded:
            if np.isfinite(recorded["scores"]).all():
                scores[path.name.removesuffix(f".{mode}.npz")] = recorded["scores"]
    return scores


def summary(versions: Sequence[Path]) -> Table:
    """Put the scores of all versions together, over each set and over all."""
    columns = ["set", "joints", "characters", "version", "L1 median", "L1 mean", "cm² median"]
    columns += ["cm² mean", "geometric mean", "of makers", f"over {LARGE}", "better : worse"]
    note = (
        f"Geometric means of cm² over the characters, and over makers. "
        f"Better and worse: characters whose cm² differ by over {NOTABLE:.0%} from the first row."
    )
    table = Table("All sets", columns, note)
    groups = [group for group in SETS[1:] if (versions[-1] / group).is_dir()]
    for name, parts in (*((group, [group]) for group in groups), ("all", groups)):
        for mode in MODES:
            before = None
            for version in versions:
                scores = {k: s for g in parts for k, s in scores_of(version / g, mode).items()}
                if not scores:
                    continue
                l1, error = np.array(list(scores.values())).T
                ratio = error / (error if before is None else before)
                table.add(
                    name,
                    mode,
                    len(scores),
                    version.name,
                    *(f"{f(l1):.3f}" for f in (np.median, np.mean)),
                    *(f"{f(error):.2f}" for f in (np.median, np.mean)),
                    f"{np.exp(np.log(error).mean()):.2f}",
                    f"{_mean_over_makers(list(scores), error):.2f}",
                    int((error > LARGE).sum()),
                    f"{(ratio < 1 - NOTABLE).sum()} : {(ratio > 1 + NOTABLE).sum()}",
                )
                before = error if before is None else before
    return table


def _mean_over_makers(names: Sequence[str], error: NDArray[np.float64]) -> float:
    """Average the logarithms of errors (n,) of each maker, and then over the makers."""
    maker = np.unique([maker_of(name) for name in names], return_inverse=True)[1]
    return float(np.exp((np.bincount(maker, np.log(error)) / np.bincount(maker)).mean()))


def worst(version: Path) -> Table:
    """List the characters with the largest deformation errors, by their makers' joints."""
    columns = ["character", "set", *(f"{m} cm²" for m in MODES), "cause"]
    table = Table("The worst characters", columns)
    scores = [
        (group, name, score[1])
        for group in SETS[1:]
        for name, score in scores_of(version / group, "known").items()
    ]
    for group, name, error in sorted(scores, key=lambda one: -one[2])[:WORST]:
        fresh = scores_of(version / group, "fresh")[name][1]
        table.add(name, group, f"{error:.1f}", f"{fresh:.1f}", CAUSES.get(name, "-"))
    return table


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    recording = commands.add_parser("record")
    recording.add_argument("folder", type=Path)
    recording.add_argument("sets", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}")
    recording.add_argument("--resolution", type=int, default=64)
    recording.add_argument("--method", choices=("animation", "paper"), default="animation")
    comparing = commands.add_parser("compare")
    comparing.add_argument("folders", type=Path, nargs="+")
    comparing.add_argument("--out", type=Path, help="a document whose tables to replace")
    options = parser.parse_args(arguments)
    if options.command == "record":
        record(options.folder, options.sets or SETS, options.resolution, options.method)
        return
    groups = {
        group: list(changes(options.folders[0] / group, options.folders[-1] / group))
        for group in SETS
        if (options.folders[-1] / group).is_dir()
    }
    tables = [summary(options.folders), largest_changes(groups), worst(options.folders[-1])]
    tables += [change_table(group, one) for group, one in groups.items()]
    text = "\n\n".join(table.markdown() for table in tables)
    print(text)
    if options.out:
        fill(options.out, {"changes": text})


if __name__ == "__main__":
    main()
