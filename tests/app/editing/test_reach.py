"""Distances over a surface: against a plain search, the plane's own, and the ball's."""

import numpy as np
import pytest

from cutcell.rig import TriangleMesh
from cutcell_app.editing.compute.reach import SurfaceReach
from tests import meshes, naive


def grid(n=12):
    """Return a square sheet of n by n cells of length 1, all cut along the same diagonal."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return TriangleMesh(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), faces)


def from_vertex(reach, vertex, limit):
    return reach.distances(reach.index[[vertex]], np.zeros(1), limit)[reach.index]


@pytest.mark.parametrize("vertex", [0, 12, 84, 100])
def test_over_a_flat_grid_they_are_at_most_8_percent_too_long(vertex):
    mesh = grid()
    straight = np.linalg.norm(mesh.vertices - mesh.vertices[vertex], axis=1)
    result = from_vertex(SurfaceReach.of(mesh), vertex, 100.0)
    assert (result >= straight - 1e-9).all()
    assert (result <= 1.0824 * straight + 1e-9).all()  # 1 / cos(22.5 degrees)


@pytest.mark.parametrize("make", [meshes.ball, meshes.torus, meshes.ball_with_holes,
                                  meshes.non_manifold, meshes.degenerate])  # fmt: skip
def test_they_are_those_of_a_plain_search(make):
    reach = SurfaceReach.of(TriangleMesh(*make()))
    ways = reach.lengths.tocoo()
    assert abs(reach.lengths - reach.lengths.T).max() == 0
    one_way = ways.row < ways.col
    edges = np.stack([ways.row, ways.col], axis=1)[one_way]
    limit = 0.4
    expected = naive.shortest_paths(len(reach.points), edges, ways.data[one_way], {0: 0.0})
    result = reach.distances(np.array([0]), np.zeros(1), limit)
    near = expected <= limit
    np.testing.assert_allclose(result[near], expected[near], rtol=0, atol=1e-12)
    assert np.isinf(result[~near]).all()
    # No way is shorter than the straight line through space.
    ends = reach.points[ways.row] - reach.points[ways.col]
    assert (ways.data >= np.linalg.norm(ends, axis=1) - 1e-12).all()


def test_on_a_ball_they_are_near_the_great_circles():
    vertices, faces = meshes.ball(4)
    result = from_vertex(SurfaceReach.of(TriangleMesh(vertices, faces)), 0, 10.0)
    out = (vertices - 0.5) / 0.45
    exact = 0.45 * np.arccos(np.clip(out @ out[0], -1, 1))
    far = exact > 0.1
    ratio = result[far] / exact[far]
    assert 0.99 < ratio.min() < ratio.max() < 1.09


def test_they_begin_where_several_vertices_already_are():
    reach = SurfaceReach.of(grid())
    corners, begin = np.array([0, 12, 12]), np.array([0.0, 3.0, 1.0])
    result = reach.distances(reach.index[corners], begin, 50.0)
    each = [
        reach.distances(reach.index[[c]], np.zeros(1), 50.0) + b
        for c, b in zip(corners, begin, strict=True)
    ]
    np.testing.assert_allclose(result, np.min(each, axis=0), atol=1e-12)
    assert reach.lengths.shape == (169, 169)
