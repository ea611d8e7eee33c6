"""By the treecode, algorithm 1 keeps the segments that it keeps by exact winding numbers."""

import tracemalloc
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import cutcell
from cutcell import TooLargeError, TriangleMesh
from cutcell.graph.rays import cast_all_rays
from cutcell.graph.segments import PointwiseWindingNumbers, inside_intervals
from cutcell.graph.surface import prepare_surface
from cutcell.graph.winding.exact import boundary_angles, winding_numbers_of
from cutcell.graph.winding.treecode.caps import smallest_caps
from cutcell.graph.winding.treecode.cells import MAX_NEAR, classify_cells
from cutcell.graph.winding.treecode.clusters import build_tree
from cutcell.graph.winding.treecode.winding_numbers import TreecodeWindingNumbers
from tests import meshes

ROOT = Path(__file__).resolve().parents[3]
RIGS = [
    *sorted((ROOT / "assets").glob("*.glb")),
    *sorted((ROOT.parent / "shared" / "data" / "rigs").glob("*.glb")),
]
"""The demo rigs, and others where there are some."""


def apart(share):
    """Shrink the triangles of a ball so that no two of them touch."""
    vertices, faces = meshes.ball(3)
    corners = vertices[faces]
    middle = corners.mean(axis=1, keepdims=True)
    points = (middle + share * (corners - middle)).reshape(-1, 3)
    return points, np.arange(len(points), dtype=np.int32).reshape(-1, 3)


def jittered():
    """Move each corner of each triangle by itself."""
    points, faces = apart(1.0)
    return points + np.random.default_rng(0).normal(0, 0.01, points.shape), faces


def many_flipped():
    """Turn every fifth triangle round, by chance."""
    vertices, faces = meshes.ball(4)
    turned = np.random.default_rng(1).random(len(faces)) < 0.2
    faces[turned] = faces[turned, ::-1]
    return vertices, faces


def confetti():
    """Triangles that have nothing in common, through each other."""
    rng = np.random.default_rng(2)
    points = rng.uniform(0.2, 0.8, (150, 1, 3)) + rng.normal(0, 0.08, (150, 3, 3))
    return points.reshape(-1, 3), np.arange(450, dtype=np.int32).reshape(-1, 3)


def large_and_loose(count):
    """Triangles that have nothing in common, as large as the unit cube."""
    vertices = np.random.default_rng(3).random((3 * count, 3))
    return vertices, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


RESOLUTION = 15
"""No power of two: then no midpoint lies on a rim, where the number is anyone's."""
SOUPS = {
    "narrow gaps": lambda: apart(0.99),
    "wide gaps": lambda: apart(0.7),
    "jittered": jittered,
    "many flipped": many_flipped,
    "confetti": confetti,
    "large and loose": lambda: large_and_loose(400),
}
SHAPES = SOUPS | meshes.OPEN


def prepared(vertices, faces, resolution):
    """Return the surface of a mesh and its hits; faces stay as they are."""
    surface = prepare_surface(TriangleMesh(vertices, faces), resolution, orient=False)
    return surface, cast_all_rays(surface.mesh.points, surface.mesh.faces, resolution)


def treecode_intervals(surface, hits, tau, report=lambda done: None):
    """Return the intervals by the winding numbers of the treecode."""
    numbers = TreecodeWindingNumbers(surface, hits, tau)
    return inside_intervals(hits, tau, numbers, surface.resolution, report)


def check_against_plain(surface, hits, tau):
    """Compare the intervals with those by winding numbers at all midpoints."""
    exact = PointwiseWindingNumbers(surface, partial(winding_numbers_of, surface.mesh))
    expected = inside_intervals(hits, tau, exact, surface.resolution)
    for one, other in zip(treecode_intervals(surface, hits, tau), expected, strict=True):
        # Without length, the midpoint is on the surface, where either number is right.
        rows, plain = (
            np.stack([r.ray, r.first, r.last, r.low, r.high], axis=1)[r.first <= r.last]
            for r in (one, other)
        )
        assert len(plain)
        np.testing.assert_array_equal(rows, plain)


@pytest.mark.parametrize("tau", [0.2, 0.3, 0.5])
@pytest.mark.parametrize("name", [n for n in SHAPES if "soup" not in n])
def test_intervals_equal_the_plain_ones(name, tau):
    vertices, faces = SHAPES[name]()
    # Turned, so that no wall lies in a plane of lattice points: a segment without length has its
    # midpoint on the surface. Symmetric meshes have the number 1/2 at many points, up to rounding.
    turned = Rotation.from_euler("xyz", [10, 20, 30], degrees=True).apply(vertices)
    check_against_plain(*prepared(turned, faces, RESOLUTION), tau - 1e-9)


@pytest.mark.parametrize("path", RIGS, ids=lambda path: path.stem)
def test_intervals_of_rigs_equal_the_plain_ones(path):
    surface = prepare_surface(cutcell.load(path).mesh, 32)
    hits = cast_all_rays(surface.mesh.points, surface.mesh.faces, surface.resolution)
    check_against_plain(surface, hits, 0.5 - 1e-9)


def test_the_midpoints_between_repeated_faces_are_evaluated_once(monkeypatch):
    vertices, faces = confetti()
    surface, hits = prepared(vertices, np.append(faces, faces[:1].repeat(300, axis=0), axis=0), 33)
    evaluated = []

    def angles(vertices, boundary, points):
        evaluated.append(points)
        return boundary_angles(vertices, boundary, points)

    numbers = "cutcell.graph.winding.treecode.winding_numbers"
    monkeypatch.setattr(f"{numbers}.boundary_angles", angles)
    check_against_plain(surface, hits, 0.5 - 1e-9)
    assert any(len(points) for points in evaluated)
    for points in evaluated:
        assert len(np.unique(points, axis=0)) == len(points)


def test_loose_triangles_take_memory_in_proportion_to_their_queries():
    resolution = 33
    surface, hits = prepared(*large_and_loose(60), resolution)
    tracemalloc.start()
    try:
        treecode_intervals(surface, hits, 0.5)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    segments = 3 * resolution**3 + sum(len(h.position) for h in hits)
    assert peak < 300 * segments


def test_cells_that_do_not_fit_in_memory_are_refused(monkeypatch):
    surface, hits = prepared(*large_and_loose(4), RESOLUTION)
    monkeypatch.setattr("cutcell.runtime.memory.available_memory", lambda: 10**4)
    treecode_intervals(surface, hits, 0.5)  # too few to look
    monkeypatch.setattr("cutcell.graph.winding.treecode.cells.UNCHECKED", 0)
    with pytest.raises(TooLargeError):
        treecode_intervals(surface, hits, 0.5)


def test_many_chunks_give_what_one_does(monkeypatch):
    surface, hits = prepared(*apart(0.7), RESOLUTION)
    expected = treecode_intervals(surface, hits, 0.5)
    reports = []
    monkeypatch.setattr("cutcell.graph.segments.CHUNK", 100)
    again = treecode_intervals(surface, hits, 0.5, reports.append)
    for one, other in zip(again, expected, strict=True):
        for name, values in vars(one).items():
            np.testing.assert_array_equal(values, getattr(other, name))
    assert len(reports) > 20
    assert reports[-1] == 1


def test_blocks_list_few_near_clusters():
    vertices, faces = large_and_loose(1000)
    clusters = build_tree(smallest_caps(vertices, meshes.boundary(faces)))
    expansions = classify_cells(clusters, RESOLUTION, 0.5).expansions
    assert len(expansions.near) > 0
    assert np.diff(expansions.start).max() <= MAX_NEAR
