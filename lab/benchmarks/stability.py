"""Measure how much weights change where the character is the same in every way that counts.

    python -m cutcell_lab.benchmarks.stability [SET...] [--resolution 64]

Each character of a set (rigs, wild, train) is bound again with noise of a millionth of its size,
with its vertices in another order, moved, turned by 90 degrees, and welded; the table lists the
share of vertices with a weight that changed by more than 0.01, in thousandths, and the largest
change. The last lines have the median and the largest change of each kind over the characters.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.rig import Rig

from .tables import Table
from .wild import SETS, characters

NOISE = 1e-6
"""Amount of noise, relative to the longest side."""
AWAY = np.array([0.37, -1.21, 2.73])
"""How far a character is moved, relative to the longest side."""
CHANGED = 0.01
"""A weight that changes by more than this has changed."""
ALLOWED = 1e-3
"""Part of the vertices that may change."""


def moved(rig: Rig, vertices: NDArray, joints: NDArray, turn: NDArray | None = None) -> Rig:
    """Return a rig without weights whose vertices and joints are elsewhere."""
    skeleton = replace(rig.skeleton, joints=joints)
    if turn is not None and skeleton.orientations is not None:
        skeleton = replace(skeleton, orientations=turn @ skeleton.orientations)
    return Rig(cutcell.TriangleMesh(vertices, rig.mesh.faces), skeleton)


def variants(rig: Rig, seed: int = 0) -> Iterator[tuple[str, Rig, NDArray[np.intp]]]:
    """Yield a name, the same character in another form, and which vertex there each one here is."""
    rng = np.random.default_rng(seed)
    vertices, joints, count = rig.mesh.vertices, rig.skeleton.joints, len(rig.mesh.vertices)
    size = np.ptp(vertices, axis=0).max()
    node = rig.mesh.welded.index
    noise = rng.uniform(-NOISE, NOISE, (int(node.max()) + 1, 3)) * size
    same = np.arange(count)
    yield "noise", moved(rig, vertices + noise[node], joints), same
    order = rng.permutation(count)
    place = np.argsort(order)
    mesh = cutcell.TriangleMesh(vertices[order], place[rig.mesh.faces])
    yield "order", Rig(mesh, rig.skeleton), place
    yield "moved", moved(rig, vertices + AWAY * size, joints + AWAY * size), same
    for axis in range(3):
        turn = np.roll(np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]), (axis, axis), (0, 1))
        yield f"turn {'xyz'[axis]}", moved(rig, vertices @ turn.T, joints @ turn.T, turn), same
    mesh = cutcell.TriangleMesh(vertices[rig.mesh.welded.first], rig.mesh.welded.faces)
    yield "weld", Rig(mesh, rig.skeleton), node


def change(rig: Rig, resolution: int = 64) -> dict[str, tuple[float, float, float]]:
    """Return the part of the vertices that change, median and largest change of each variant."""
    rig = Rig(rig.mesh, rig.skeleton)
    weights = cutcell.bind(rig, resolution).weights
    result = {}
    for name, other, place in variants(rig):
        away = np.abs(cutcell.bind(other, resolution).weights[place] - weights).max(axis=1)
        part = (away > CHANGED).mean()
        result[name] = float(part), float(np.median(away)), float(away.max())
    return result


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sets", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}")
    parser.add_argument("--resolution", type=int, default=64)
    options = parser.parse_args(arguments)
    table: Table | None = None
    measured: dict[str, list[tuple[float, float, float]]] = {}
    for group in options.sets or SETS:
        for name, rig in characters(group):
            changes = change(rig, options.resolution)
            table = table or Table("Stability", ["character", *changes, "largest"])
            table.add(
                name,
                *(f"{1000 * part:.1f}" for part, _, _ in changes.values()),
                f"{max(largest for _, _, largest in changes.values()):.2f}",
            )
            for variant, values in changes.items():
                measured.setdefault(variant, []).append(values)
            parts = {key: f"{1000 * part:.1f}" for key, (part, _, _) in changes.items()}
            print(name, parts, flush=True)
    if table:
        print(table.markdown())
    for variant, values in measured.items():
        part, middle, largest = np.array(values).T
        print(
            f"{variant}: {(part <= ALLOWED).sum()} of {len(part)} stable, "
            f"median vertex {np.median(middle):.4f} (at most {middle.max():.4f}), "
            f"worst vertex {np.median(largest):.3f} (at most {largest.max():.3f})"
        )


if __name__ == "__main__":
    main()
