"""Which faces of real meshes are inside out, and what becomes of meshes that are inverted.

python -m cutcell_lab.benchmarks.orientation [FILE ...] [--resolution R] [--markdown OUT]

For each mesh: as it is in the file, inverted as a whole, and with a ball of faces inverted. Meshes
of which nothing is turned, and whose inside is the same in all three, are only counted.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell import CutcellError, TriangleMesh, build_graph
from cutcell.geometry.triangles import areas
from cutcell.graph import INTERIOR, inverted_faces

from .rigs import SHARED, rig_paths
from .tables import Table, percent, publish

BALL = 0.2
"""Radius of the ball of faces, in the mesh's longest side."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--resolution", type=int, default=48)
    parser.add_argument("--markdown", type=Path)
    options = parser.parse_args(arguments)
    columns = (
        "mesh", "faces", "turned", "inside", "as the file has it", "of an inverted mesh",
        "of one with an inverted part", "part missed",
    )  # fmt: skip
    note = (
        f"Faces turned, and interior nodes of the graph at R = {options.resolution}: as "
        "`build_graph` has them; with the faces as they run in the file; of the mesh inverted as a "
        "whole; of one with a ball of faces inverted, and how much of its surface is then wrong."
    )
    table = Table("Orientation of faces", columns, note)
    alike = 0
    for name, mesh in meshes(options.files):
        row, is_alike = measure(mesh, options.resolution)
        alike += is_alike
        if not is_alike:
            table.add(name, f"{len(mesh.faces):,}", *row)
    table.add(f"**nothing turned, all the same: {alike}**", *[""] * (len(columns) - 1))
    publish([table], options.markdown)


def meshes(paths: Sequence[Path]) -> Iterator[tuple[str, TriangleMesh]]:
    """Load meshes by path; all at hand when none is named, less those that cannot be read."""
    for path in paths or [*rig_paths(), *_others()]:
        try:
            yield path.stem, cutcell.load(path).mesh
        except CutcellError:
            if paths:
                raise


def _others() -> list[Path]:
    others = [*(SHARED / "wild").rglob("*"), *(SHARED / "train").rglob("*.npz")]
    return sorted(path for path in others if path.suffix in (".glb", ".gltf", ".npz"))


def measure(mesh: TriangleMesh, resolution: int) -> tuple[list[str], bool]:
    """Return the cells of a row, and whether they hold nothing to look at."""
    vertices, faces = mesh.vertices, mesh.faces
    turned = inverted_faces(mesh)
    part = in_ball(mesh)
    whole = TriangleMesh(vertices, faces[:, ::-1])
    damaged = TriangleMesh(vertices, np.where(part[:, None], faces[:, ::-1], faces))
    wrong = inverted_faces(damaged) != (part ^ turned)
    area = areas(vertices[faces])
    missed = float(area[wrong].sum() / area.sum())
    counts = [
        int(
            (
                build_graph(one, resolution, connectivity=6, orient=orient).node_kind == INTERIOR
            ).sum()
        )
        for one, orient in ((mesh, True), (mesh, False), (whole, True), (damaged, True))
    ]
    cells = [str(int(turned.sum())), *(f"{count:,}" for count in counts), percent(missed)]
    return cells, len({*counts}) == 1 and not turned.any()


def in_ball(mesh: TriangleMesh) -> NDArray[np.bool_]:
    """Return the faces around one that is drawn by the mesh's own numbers, shape (m,)."""
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    centre = middle[np.random.default_rng(len(middle)).integers(len(middle))]
    radius = BALL * float(np.ptp(mesh.bounds, axis=0).max())
    inside: NDArray[np.bool_] = np.linalg.norm(middle - centre, axis=1) < radius
    return inside


if __name__ == "__main__":
    main()
