"""The nodes found are those that comparing with all nodes finds."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from cutcell.bones.nearest import NodeGrid


@pytest.mark.parametrize("resolution", [2, 16, 64])
@pytest.mark.parametrize("count", [1, 40, 3000])
def test_nearest_are_those_of_all(resolution, count):
    random = np.random.default_rng(count + resolution)
    nodes = random.random((count, 3))
    nodes[::3] = (np.floor(nodes[::3] * 8) + 0.5) / 8  # many at equal distances
    chosen = random.random(count) < 0.7
    chosen[0] = True
    inside = random.random((50, 3))
    outside = random.normal(0.5, 2, (50, 3))
    corners = np.stack(np.meshgrid(*[np.arange(9) / 8] * 3), axis=-1).reshape(-1, 3)
    points = np.concatenate([inside, outside, corners])
    apart = np.where(chosen, cdist(points, nodes), np.inf)
    expected = np.nonzero(apart <= apart.min(axis=1, keepdims=True) + 1e-9)
    point, node = NodeGrid(nodes, chosen, resolution).nearest(points)
    assert (np.diff(point) >= 0).all()
    assert set(zip(point, node, strict=True)) == set(zip(*expected, strict=True))


def test_nodes_with_a_points_label_are_passed_over():
    random = np.random.default_rng(0)
    nodes, points = random.random((300, 3)), random.random((50, 3))
    label, own = random.integers(0, 3, 300), random.integers(0, 3, 50)
    away = np.where(label == own[:, None], np.inf, cdist(points, nodes))
    point, node = NodeGrid(nodes, np.ones(300, bool), 16, label).nearest(points, own)
    np.testing.assert_array_equal(point, np.arange(50))
    np.testing.assert_array_equal(node, away.argmin(axis=1))


def test_a_crowd_at_one_place_is_found_whole():
    nodes = np.full((100, 3), 0.25)
    grid = NodeGrid(nodes, np.ones(100, bool), 64)
    point, node = grid.nearest(np.array([[0.75, 0.5, 1.5]]))
    assert not point.any()
    assert sorted(node) == list(range(100))


@pytest.mark.parametrize("resolution", [3, 17, 64])
def test_beside_are_those_in_neighbouring_cells(resolution):
    random = np.random.default_rng(resolution)
    nodes = np.concatenate([random.random((60, 3)), [[1.0, 1, 1], [0, 0, 0]]])
    chosen = random.random(len(nodes)) < 0.7
    outside = random.normal(0.5, 1, (100, 3)), np.full((1, 3), 1e12), np.full((1, 3), -1e12)
    points = np.concatenate([random.random((400, 3)), nodes, *outside])
    cells, others = (np.floor(x * resolution) for x in (points, nodes[chosen]))
    expected = (np.abs(cells[:, None] - others).max(axis=2) <= 1).any(axis=1)
    result = NodeGrid(nodes, chosen, resolution).near(points)
    assert 0 < expected.sum() < len(points)
    np.testing.assert_array_equal(result, expected)
