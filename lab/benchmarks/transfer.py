"""Take the clothes off dressed humans, and put them back by transfer.

    python -m cutcell_lab.benchmarks.transfer [--out docs/transfer.md]

The body is the source. A garment gets weights from the closest point of the body, by plain
in-painting (Abdrashitov et al. 2023: the closest point within 5 % of the diagonal and 30 degrees),
and by `cutcell.transfer`. Each is compared with the maker's own weights. Levels of detail are the
same bodies, bound by cutcell, with a half and a quarter of their triangles by Open3D's quadric
decimation: the error of the transferred weights against the maker's is compared with that of the
bound weights of the source.

Other characters have no body under what lies on them: each component is taken off and put back on
the rest. There are many of these, so that rules are judged on them.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.editing.transfer.inpainting import inpaint
from cutcell.rig import Rig, TriangleMesh

from ..metrics import deformation_error
from .document import fill
from .makers import maker_of
from .rigs import SHARED
from .tables import Table
from .wild import characters

DRESSED: dict[str, tuple[str | int, tuple[str | int, ...]]] = {
    "rigs/makehuman_clothed_mixamo.glb": ("body", ("tights", "skirt", "hair")),
    "wild/polyme_17skins.glb": (
        "body_MSH",
        (
            "top_tee_MSH", "top_sweater_MSH", "bottom_jeans_MSH", "bottom_shorts_MSH",
            "shoes_basic_MSH", "hair_male_MSH", "hair_female_MSH",
        ),
    ),
    "wild/valid_AIAN_F_1_Busi.glb": ("H_DDS_HighRes", ("h_wig",)),
    "more/mannyquin.npz": (0, (1, 2, 4, 5)),
    "more/minnyquinn.npz": (0, (1, 2, 3)),
}  # fmt: skip
"""Bodies and garments: names of meshes, or numbers of components where a file has one mesh."""
DETAIL = (0.5, 0.25)
METHODS = ("nearest point", "in-painting", "cutcell")
PARTS, MIN_VERTICES = 10, 20
"""Components that are taken off a character, at most, and vertices of one, at least."""
CHANGE, SMALL = 0.03, 0.01
"""An error is better or worse if it changes by this part; so many cm² are added to each before."""


def part_of(rig: Rig, which: str | int) -> Rig:
    """Return a mesh or a component of a rig as a rig by itself."""
    if isinstance(which, str):
        slices = {part.name: part.vertices for part in rig.parts}
        chosen = np.zeros(len(rig.mesh.vertices), bool)
        chosen[slices[which]] = True
    else:
        chosen = rig.mesh.welded.component[rig.mesh.welded.index] == which
    mesh, weights = taken(rig, chosen)
    return Rig(mesh, rig.skeleton, weights)


def taken(rig: Rig, chosen: NDArray[np.bool_]) -> tuple[TriangleMesh, NDArray[np.float64]]:
    """Return some vertices (n,) of a rig, with the faces between them, and their weights."""
    number = np.cumsum(chosen) - 1
    faces = number[rig.mesh.faces[chosen[rig.mesh.faces].all(axis=1)]]
    assert rig.weights is not None
    return TriangleMesh(rig.mesh.vertices[chosen], faces), rig.weights[chosen]


def closest(body: Rig, mesh: TriangleMesh) -> tuple[NDArray, NDArray, NDArray]:
    """Return weights and normals of a body at the closest points, and the distances, by Open3D."""
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    faces = body.mesh.faces.astype(np.uint32)
    scene.add_triangles(body.mesh.vertices.astype(np.float32), faces)
    hit = scene.compute_closest_points(mesh.vertices.astype(np.float32))
    u, v = hit["primitive_uvs"].numpy().T
    share = np.maximum(np.stack([1 - u - v, u, v], axis=1), 0)  # they are rounded to 32 bits
    share /= share.sum(axis=1, keepdims=True)
    corners = body.mesh.faces[hit["primitive_ids"].numpy()]
    assert body.weights is not None
    normals = body.mesh.welded.normals[body.mesh.welded.index]
    distance = np.linalg.norm(hit["points"].numpy() - mesh.vertices, axis=1)
    at = [np.einsum("pc,pcx->px", share, values[corners]) for values in (body.weights, normals)]
    return at[0], at[1], distance


def nearest(body: Rig, mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return the weights of the closest points."""
    return closest(body, mesh)[0]


def plain(body: Rig, mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return weights by in-painting as published."""
    welded = mesh.welded
    weights, normals, distance = (values[welded.first] for values in closest(body, mesh))
    cosine = np.einsum("px,px->p", normals, welded.normals)
    cosine /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    diagonal = np.linalg.norm(np.ptp(body.mesh.bounds, axis=0))
    fits = (distance <= 0.05 * diagonal) & (cosine >= np.cos(np.radians(30)))
    return inpaint(welded, fits, weights)[welded.index]


def transferred(body: Rig, mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return weights by `cutcell.transfer`."""
    return cutcell.transfer(body, mesh, max_influences=None).weights


def garments() -> Iterator[tuple[str, str, int, list[float]]]:
    """Yield the character, the garment, its vertices, and the error of each method."""
    for file, (body, worn) in DRESSED.items():
        rig = cutcell.load(SHARED / file)
        source = part_of(rig, body)
        for name in worn:
            one = part_of(rig, name)
            assert one.weights is not None
            result = errors(source, one.mesh, one.weights)
            yield Path(file).stem, str(name), len(one.mesh.vertices), result


def errors(source: Rig, mesh: TriangleMesh, made: NDArray[np.float64]) -> list[float]:
    """Return the error of each method against the maker's weights."""
    ways: tuple[Callable[[Rig, TriangleMesh], NDArray], ...] = (nearest, plain, transferred)
    one = mesh, source.skeleton
    return [deformation_error(one, way(source, mesh), made, joints="all").mean for way in ways]


def components() -> Iterator[tuple[str, list[float]]]:
    """Yield a character and the errors of each method for one of its largest components.

    Each has at most half of the vertices, and half of its vertices are near to the rest.
    """
    for name, rig in (one for group in ("rigs", "wild", "more") for one in characters(group)):
        assert rig.weights is not None
        welded, weighted = rig.mesh.welded, rig.weights.any(axis=1)
        counts, number = np.bincount(welded.component), 0
        diagonal = np.linalg.norm(np.ptp(rig.mesh.bounds, axis=0))
        for component in np.argsort(-counts, kind="stable"):
            worn = welded.component[welded.index] == component
            is_garment = MIN_VERTICES <= counts[component] <= len(welded.points) / 2
            if number == PARTS or not (is_garment and weighted[worn].all()):
                continue
            mesh, made = taken(rig, worn)
            rest, weights = taken(rig, ~worn & weighted)
            source = Rig(rest, rig.skeleton, weights)
            if np.median(closest(source, mesh)[2]) > 0.05 * diagonal:
                continue
            number += 1
            result = errors(source, mesh, made)
            print(name, component, *result, flush=True)
            yield name, result


def compared(results: list[tuple[str, list[float]]]) -> Table:
    """Count the components, and the makers by the mean logarithm of the ratio, that are better."""
    names = ["against", "better", "worse", "makers better", "makers worse"]
    table = Table("Components", names)
    makers = np.array([maker_of(name) for name, _ in results])
    every = np.array([one for _, one in results])
    ours = every[:, 2]
    for method, other in zip(METHODS[:2], every.T[:2], strict=True):
        ratio = np.log((ours + SMALL) / (other + SMALL))
        mean = np.array([ratio[makers == maker].mean() for maker in np.unique(makers)])
        counts = [
            (sign * values > np.log1p(CHANGE)).sum() for values in (ratio, mean) for sign in (-1, 1)
        ]
        table.add(method, *counts)
    return table


def details() -> Iterator[tuple[str, int, float, float]]:
    """Yield a body, the triangles of a level, and the errors of bound weights on either."""
    import open3d as o3d

    for file, (body, _) in DRESSED.items():
        source = part_of(cutcell.load(SHARED / file), body)
        assert source.weights is not None
        bound = source.with_weights(cutcell.bind(source).weights)
        error = over_area(source, bound.weights, source.weights)
        welded = source.mesh.welded
        points, faces = source.mesh.vertices[welded.first], welded.faces[welded.is_whole]
        full = o3d.geometry.TriangleMesh(
            o3d.utility.Vector3dVector(points), o3d.utility.Vector3iVector(faces)
        )
        for part in DETAIL:
            coarse = full.simplify_quadric_decimation(int(part * len(faces)))
            mesh = TriangleMesh(np.asarray(coarse.vertices), np.asarray(coarse.triangles))
            level, made = Rig(mesh, source.skeleton), nearest(source, mesh)
            yield (
                Path(file).stem,
                len(mesh.faces),
                error,
                over_area(level, transferred(bound, mesh), made),
            )


def over_area(rig: Rig, weights: NDArray[np.float64], reference: NDArray[np.float64]) -> float:
    """Return the mean error over the surface: levels have their vertices in other places."""
    welded = rig.mesh.welded
    vertex = deformation_error(rig, weights, reference, joints="all").vertex[welded.first]
    return float(np.average(vertex, weights=welded.areas))


def main() -> None:
    """Print the tables, or write them into a document."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path)
    out = parser.parse_args().out
    clothes = Table("Clothes", ["character", "garment", "vertices", *METHODS])
    totals: dict[str, NDArray] = {}
    for name, garment, count, errors in garments():
        clothes.add(name, garment, f"{count:,}", *(f"{error:.4f}" for error in errors))
        totals[name] = totals.get(name, np.zeros(3)) + np.array(errors) * count
        totals["vertices " + name] = totals.get("vertices " + name, np.zeros(1)) + count
        print(name, garment, *errors, flush=True)
    humans = Table("Humans", ["character", *METHODS])
    for name in [name for name in totals if not name.startswith("vertices ")]:
        humans.add(name, *(f"{e:.4f}" for e in totals[name] / totals["vertices " + name]))
    levels = Table("Levels of detail", ["body", "triangles", "source", "level", "ratio"])
    for name, count, error, level in details():
        levels.add(name, f"{count:,}", f"{error:.4f}", f"{level:.4f}", f"{level / error:.3f}")
        print(name, count, error, level, flush=True)
    parts = compared(list(components()))
    blocks = {"humans": humans, "clothes": clothes, "components": parts, "detail": levels}
    if out is None:
        print(*(table.markdown() for table in blocks.values()), sep="\n\n")
    else:
        fill(out, {name: table.markdown() for name, table in blocks.items()})


if __name__ == "__main__":
    main()
