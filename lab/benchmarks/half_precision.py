"""Measure weights of characters whose positions are rounded to 16 bits, as some data sets are.

    python -m cutcell_lab.benchmarks.half_precision [SET...] [--out docs/dataset.md]

Each character is brought to the cube from -1 to 1, as Rig-XL, VRoid and RigNet's archives are in
UniRig's form, and bound twice: as its file has it, and with positions rounded to float16.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import cutcell
from cutcell.rig import Rig, TriangleMesh

from ..metrics import vertex_shares, weight_l1
from .document import fill
from .tables import Table
from .wild import characters, score_of

SETS = ("rigs", "wild", "more")
WORST = 5


@dataclass(frozen=True)
class Twin:
    """A character beside its rounded twin; errors are L1 and cm2."""

    name: str
    collapsed: int
    faces: int
    own: tuple[float, float]
    rounded: tuple[float, float]
    between: float


def in_cube(rig: Rig) -> Rig:
    """Bring a character to the cube from -1 to 1."""
    low, high = rig.mesh.bounds
    centre, half = (low + high) / 2, (high - low).max() / 2
    skeleton = replace(rig.skeleton, joints=(rig.skeleton.joints - centre) / half)
    plain = replace(rig, weights=None, allowed=None, parts=(), attachments=(), clips=(),
                    weight_sums=None, source=None)  # fmt: skip
    mesh = TriangleMesh((rig.mesh.vertices - centre) / half, rig.mesh.faces)
    return replace(plain, mesh=mesh, skeleton=skeleton)


def rounded(rig: Rig) -> Rig:
    """Round all positions to float16."""
    vertices, joints = (
        points.astype(np.float16).astype(np.float64)
        for points in (rig.mesh.vertices, rig.skeleton.joints)
    )
    skeleton = replace(rig.skeleton, joints=joints)
    return replace(rig, mesh=TriangleMesh(vertices, rig.mesh.faces), skeleton=skeleton)


def measure(name: str, rig: Rig, resolution: int) -> Twin:
    """Bind a character and its rounded twin."""
    own = in_cube(rig)
    twin = rounded(own)
    weights = [cutcell.bind(one, resolution).weights for one in (own, twin)]
    scores = [score_of(rig, one) for one in weights]
    whole = [one.mesh.welded.is_whole for one in (own, twin)]
    return Twin(
        name,
        int((whole[0] & ~whole[1]).sum()),
        len(rig.mesh.faces),
        (scores[0].l1, scores[0].deformation),
        (scores[1].l1, scores[1].deformation),
        weight_l1(*weights, vertex_shares(rig.mesh, "welded")),
    )


def tables(twins: Sequence[Twin]) -> list[Table]:
    """Put medians and the characters that change most into tables."""
    whole = Table(
        "Both beside the artists", ["positions", "L1 median", "L1 mean", "cm² median", "cm² mean"],
        f"{len(twins)} characters, beside their artists' weights. The median L1 between both is "
        f"{np.median([one.between for one in twins]):.3f}.",
    )  # fmt: skip
    for name in ("own", "rounded"):
        l1, moved = np.array([getattr(one, name) for one in twins]).T
        whole.add(
            name, *(f"{np.median(v):.3f}" for v in (l1,)), f"{l1.mean():.3f}",
            f"{np.median(moved):.2f}", f"{moved.mean():.2f}",
        )  # fmt: skip
    worst = Table(
        "Characters that change most",
        ["character", "L1 between", "L1 own, rounded", "triangles that collapse"],
    )
    for one in sorted(twins, key=lambda one: -one.between)[:WORST]:
        share = f"{one.collapsed:,} of {one.faces:,}"
        errors = f"{one.own[0]:.3f}, {one.rounded[0]:.3f}"
        worst.add(one.name, f"{one.between:.3f}", errors, share)
    return [whole, worst]


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sets", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--out", type=Path, help="a document whose tables to replace")
    options = parser.parse_args(arguments)
    twins = []
    for group in options.sets or SETS:
        for name, rig in characters(group):
            twins.append(measure(name, rig, options.resolution))
            print(f"{name}: {twins[-1].between:.3f}", flush=True)
    text = "\n\n".join(table.markdown() for table in tables(twins))
    print(text)
    if options.out:
        fill(options.out, {"half-precision": text})


if __name__ == "__main__":
    main()
