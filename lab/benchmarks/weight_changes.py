"""Show where weights differ between two versions of the code, and whether they got better.

    python -m cutcell_lab.benchmarks.weight_changes record FOLDER [SET...] [--method M]
    python -m cutcell_lab.benchmarks.weight_changes compare OLD NEW [--out docs/quality.md]

`record` binds all characters of the sets (demos, rigs, wild, more) with the joints of their makers
("known") and with their weights forgotten ("fresh"), and writes the weights into a folder; run it
in a checkout of each version. `compare` reads two such folders and prints tables.
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
from .rigs import ROOT
from .tables import Table
from .wild import MODES, characters, score_of

SETS = ("demos", "rigs", "wild", "more")
CHANGED = 0.01
"""A weight that differs by more than this has changed."""
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
    """List the characters of a set whose weights changed."""
    columns = ["character", "joints", "vertices changed", "L1", "cm²", "differs first in"]
    table = Table(group, columns)
    for one in listed:
        if one.vertices:
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


def summary(groups: dict[str, list[Change]]) -> Table:
    """Put medians and means of all sets together."""
    columns = ["set", "joints", "characters", "changed", "L1 median", "L1 mean", "cm² median"]
    columns += ["cm² mean", "cm² geometric mean", "over 20 cm²", "better : worse"]
    table = Table("All sets", columns)
    rows = [(group, [one]) for group, one in groups.items() if group != "demos"]
    rows.append(("all", [one for group, one in groups.items() if group != "demos"]))
    for group, parts in rows:
        for mode in MODES:
            chosen = [one for part in parts for one in part if one.mode == mode]
            l1 = np.array([one.l1 for one in chosen])
            error = np.array([one.deformation for one in chosen])
            ratio = error[:, 1] / error[:, 0]
            table.add(
                group,
                mode,
                len(chosen),
                sum(one.vertices > 0 for one in chosen),
                *("{:.3f} → {:.3f}".format(*f(l1, axis=0)) for f in (np.median, np.mean)),
                *("{:.2f} → {:.2f}".format(*f(error, axis=0)) for f in (np.median, np.mean)),
                "{:.2f} → {:.2f}".format(*np.exp(np.log(error).mean(axis=0))),
                "{} → {}".format(*(error > 20).sum(axis=0)),
                f"{(ratio < 1 - NOTABLE).sum()} : {(ratio > 1 + NOTABLE).sum()}",
            )
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
    comparing.add_argument("old", type=Path)
    comparing.add_argument("new", type=Path)
    comparing.add_argument("--out", type=Path, help="a document whose tables to replace")
    options = parser.parse_args(arguments)
    if options.command == "record":
        record(options.folder, options.sets or SETS, options.resolution, options.method)
        return
    groups = {
        group: list(changes(options.old / group, options.new / group))
        for group in SETS
        if (options.new / group).is_dir()
    }
    tables = [summary(groups), largest_changes(groups)]
    tables += [change_table(group, one) for group, one in groups.items()]
    text = "\n\n".join(table.markdown() for table in tables)
    print(text)
    if options.out:
        fill(options.out, {"changes": text})


if __name__ == "__main__":
    main()
