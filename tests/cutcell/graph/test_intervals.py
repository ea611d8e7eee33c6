"""Inside intervals equal those that exact winding numbers give, segment by segment."""

import tracemalloc

import numpy as np
import pytest

from cutcell import TriangleMesh, winding_number
from cutcell.geometry.weld import weld
from cutcell.graph.fast_winding import list_segments
from cutcell.graph.rays import cast_all_rays
from cutcell.graph.winding import intervals
from cutcell.graph.winding.boundary import find_boundary
from cutcell.graph.winding.intervals import inside_intervals
from cutcell.graph.winding.treecode.caps import smallest_caps
from cutcell.graph.winding.treecode.cells import MAX_NEAR, classify_cells
from cutcell.graph.winding.treecode.clusters import build_tree
from cutcell.graph.winding.treecode.queries import query_points
from tests import meshes


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


@pytest.mark.parametrize("tau", [0.2, 0.3, 0.5])
@pytest.mark.parametrize("name", [n for n in SHAPES if "soup" not in n])
def test_intervals_equal_those_of_exact_numbers(name, tau):
    vertices, index = weld(SHAPES[name]()[0])
    faces = index[SHAPES[name]()[1]]
    tau -= 1e-9  # symmetric meshes have the number 1/2 at many places, up to rounding
    boundary = find_boundary(faces)
    hits = cast_all_rays(vertices, faces, RESOLUTION)
    inside = inside_intervals(vertices, faces, hits, boundary, RESOLUTION, tau)
    for axis in range(3):
        segments = list_segments(hits[axis], RESOLUTION, closed=False)
        number = winding_number(TriangleMesh(vertices, faces), segments.points(RESOLUTION, axis))
        expected = segments.intervals(segments.has_ends & (number >= tau))
        long = expected.first <= expected.last  # without length, the number is anyone's
        rows, others = (
            np.stack([r.ray, r.first, r.last, r.low, r.high], axis=1)[r.first <= r.last]
            for r in (inside[axis], expected)
        )
        assert long.any()
        np.testing.assert_array_equal(rows, others)


def test_loose_triangles_take_memory_in_proportion_to_their_queries():
    vertices, faces = large_and_loose(60)
    resolution = 33
    boundary, hits = find_boundary(faces), cast_all_rays(vertices, faces, resolution)
    tracemalloc.start()
    try:
        inside_intervals(vertices, faces, hits, boundary, resolution, 0.5)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    segments = 3 * resolution**3 + sum(len(h.position) for h in hits)
    assert peak < 300 * segments


def test_queries_are_answered_some_at_a_time_with_the_same_result(monkeypatch):
    vertices, faces = apart(0.7)
    boundary, hits = find_boundary(faces), cast_all_rays(vertices, faces, RESOLUTION)
    given = vertices, faces, hits, boundary, RESOLUTION, 0.5
    monkeypatch.setattr("cutcell.graph.rays.STRIP_WORK", 1000)
    expected = inside_intervals(*given)
    sizes, reports = [], []

    def counted(expansions, clusters, row, queries, tell):
        sizes.append(len(queries))
        return query_points(expansions, clusters, row, queries, tell)

    monkeypatch.setattr(intervals, "query_points", counted)
    monkeypatch.setattr(intervals, "MAX_QUERIES", 1000)
    for one, other in zip(inside_intervals(*given, reports.append), expected, strict=True):
        for name, values in vars(one).items():
            np.testing.assert_array_equal(values, getattr(other, name))
    assert len(sizes) > 3
    assert max(sizes) < sum(sizes) / 3
    assert reports == sorted(reports)
    assert reports[-1] == 1


def test_blocks_list_few_near_clusters():
    vertices, faces = large_and_loose(1000)
    clusters = build_tree(smallest_caps(vertices, find_boundary(faces)))
    expansions = classify_cells(clusters, RESOLUTION, 0.5).expansions
    assert len(expansions.near) > 0
    assert np.diff(expansions.start).max() <= MAX_NEAR
