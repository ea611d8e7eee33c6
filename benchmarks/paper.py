"""The paper's tables and figures that need no network, into docs/paper.md and docs/quality.md.

    python -m benchmarks.paper [PART...] [--rigs RIG...]

Parts: construction, runtime, optimisation, gvb, deformation, unreachable; all when none is named,
which takes an hour or two, most of it meshers and solvers. The first four are separate scripts,
run here with the options that the documents were printed with.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

import cutcell
from cutcell.geodesics.fallback import UNREACHED
from cutcell_lab.baselines import METHODS
from cutcell_lab.benchmarks import gvb, optimisation, runtime
from cutcell_lab.benchmarks.document import fill
from cutcell_lab.benchmarks.rigs import ROOT, SHARED
from cutcell_lab.benchmarks.tables import Table
from cutcell_lab.benchmarks.wild import files_of
from cutcell_lab.metrics import TURNED, deformation_error

from . import graph_construction

PAPER, QUALITY = ROOT / "docs" / "paper.md", ROOT / "docs" / "quality.md"
PICTURE = ROOT / "docs" / "pictures" / "gvb.png"
SMALL = (
    "khronos_CesiumMan",
    "khronos_Fox",
    "khronos_RiggedFigure",
    "quaternius_trex",
    "quaternius_wolf",
)
"""The rigs for timings: on larger ones meshers and solvers mostly do not end."""
SIDES = ("cutcell", "cutcell_any", "cutcell_rig", "voxel", "euclidean")
SETS = ("rigs", "wild")


def deformation_table(groups: dict[str, Sequence[Path]]) -> Table:
    """Measure the deformation error both ways."""
    title_words = [f"{kind} {word}" for word in TURNED for kind in ("median", "mean")]
    columns = ["set", "characters", "joints turned: deform, all", "method", *title_words]
    note = "cm², R = 64. Over the characters of each set; the joints turned are means."
    table = Table("The deformation error both ways", columns, note)
    for group, paths in groups.items():
        rows_of: dict[str, list[list[float]]] = {name: [] for name in SIDES}
        counts = []
        for path in paths:
            rig = cutcell.load(path)
            if rig.weights is None or not rig.weights.any():
                continue
            counts.append((rig.skeleton.deform.sum(), len(rig.skeleton.joints)))
            for name in SIDES:
                options = {} if name == "euclidean" else {"resolution": 64}
                weights = METHODS[name](rig, **options).weights
                rows_of[name].append(
                    [
                        deformation_error(rig, weights, rig.weights, joints=word).mean
                        for word in TURNED
                    ]
                )
        turned = ", ".join(f"{n:.0f}" for n in np.mean(counts, axis=0))
        for name, rows in rows_of.items():
            of = [f(rows, axis=0) for f in (np.median, np.mean)]
            cells = [f"{of[kind][k]:.2f}" for k in range(len(TURNED)) for kind in range(2)]
            table.add(group, len(counts), turned, name, *cells)
    return table


def unreachable_table(groups: dict[str, Sequence[Path]]) -> Table:
    """Count the vertices that no path reaches."""
    columns = ["set", "characters", "with any", "largest share", "of"]
    note = "R = 64, the paper's method: vertices with paths from no bone, of all of a character."
    table = Table("Vertices that no path reaches", columns, note)
    for group, paths in groups.items():
        shares = {}
        for path in paths:
            rig = cutcell.load(path)
            graph = cutcell.build_graph(rig.mesh, method="paper")
            distances = cutcell.bone_distances(graph, rig.skeleton, method="paper")
            # A glTF in parts is named by its folder: its document is often called scene.
            name = path.parent.name if path.suffix == ".gltf" else path.stem
            shares[name] = float((distances.fallback == UNREACHED).mean())
        worst = max(shares, key=lambda name: shares[name])
        affected = sum(share > 0 for share in shares.values())
        table.add(group, len(shares), affected, f"{shares[worst]:.1%}", worst)
    return table


def construction(rigs: Sequence[Path]) -> None:
    """Print the paper's table of graph construction."""
    graph_construction.main([*map(str, rigs or _small()), "--limit", "120", "--out", str(PAPER)])


def stages(rigs: Sequence[Path]) -> None:
    """Print the paper's figure of time by stage."""
    listed = map(str, rigs or _small())
    runtime.main([*listed, "--resolutions", "32", "64", "128", "--out", str(PAPER)])


def solvers(rigs: Sequence[Path]) -> None:
    """Print the paper's figure of shortest paths against optimisation."""
    optimisation.main([*map(str, rigs or _small()), "--limit", "60", "--out", str(PAPER)])


def over_resolution(rigs: Sequence[Path]) -> None:
    """Print the paper's figure beside geodesic voxel binding, over R."""
    gvb.main([*map(str, rigs), "--plot", str(PICTURE), "--out", str(QUALITY)])


def deformation(rigs: Sequence[Path]) -> None:
    """Print the deformation error both ways."""
    _print("deformation", deformation_table(_groups(rigs)))


def unreachable(rigs: Sequence[Path]) -> None:
    """Print how many vertices no path reaches."""
    _print("unreachable", unreachable_table(_groups(rigs)))


def _groups(rigs: Sequence[Path]) -> dict[str, Sequence[Path]]:
    return {"named": rigs} if rigs else {group: files_of(group) for group in SETS}


def _print(name: str, table: Table) -> None:
    print(table.markdown())
    fill(PAPER, {name: table.markdown()})


PARTS: dict[str, Callable[[Sequence[Path]], None]] = {
    "construction": construction,
    "runtime": stages,
    "optimisation": solvers,
    "gvb": over_resolution,
    "deformation": deformation,
    "unreachable": unreachable,
}


def _small() -> list[Path]:
    return [SHARED / "rigs" / f"{name}.glb" for name in SMALL]


def main(argv: Sequence[str] | None = None) -> None:
    """Read the command line, and print the parts."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.paper", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--rigs", nargs="*", type=Path, default=[])
    options = parser.parse_args(argv)
    if unknown := [name for name in options.parts if name not in PARTS]:
        parser.error(f"no part {unknown[0]}; there are {', '.join(PARTS)}")
    for name in options.parts or PARTS:
        PARTS[name](options.rigs)


if __name__ == "__main__":
    main()
