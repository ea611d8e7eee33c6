"""Equal points become one, whatever order they come in; edges are counted with their sense."""

import time
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from cutcell.geometry.edges import find_edges
from cutcell.geometry.weld import weld
from tests import meshes


@settings(max_examples=40)
@given(st.integers(0, 10**6))
def test_groups_are_the_connected_ones(seed):
    rng = np.random.default_rng(seed)
    # Copies, near copies and chains of them, on a coarse grid: many share planes.
    points = rng.integers(0, 4, (60, 3)) / 4.0
    points += rng.integers(-2, 3, points.shape) * rng.choice([0, 0.4e-6, 0.9e-6], (60, 1))
    pairs = cKDTree(points).query_pairs(1e-6, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(60, 60))
    count, labels = connected_components(links, directed=False)
    welded, index = weld(points, 1e-6)
    assert len(welded) == count
    assert len(set(zip(labels.tolist(), index.tolist(), strict=True))) == count
    for k, middle in enumerate(welded):
        group = points[index == k]
        np.testing.assert_array_equal(middle, (group.min(axis=0) + group.max(axis=0)) / 2)

    shuffled = rng.permutation(60)
    again, other = weld(points[shuffled], 1e-6)
    np.testing.assert_array_equal(again, welded)
    np.testing.assert_array_equal(other, index[shuffled])


def test_a_pile_of_points_at_one_place_is_no_trouble():
    welded, index = weld(np.full((200_000, 3), 0.3))
    assert welded.tolist() == [[0.3, 0.3, 0.3]]
    assert not index.any()


def test_a_stray_far_away_is_no_reason_to_compare_all_points():
    points = np.random.default_rng(3).random((30_000, 3))
    begin = time.process_time()
    welded, index = weld(np.vstack([points, [[1e40, 0, 0]]]))
    assert time.process_time() - begin < 2  # all pairs took five times as long
    np.testing.assert_array_equal(np.sort(index[:-1]), np.sort(weld(points)[1]))
    assert len(welded) == len(weld(points)[0]) + 1


@pytest.mark.parametrize("name", meshes.ALL)
def test_edges_and_their_balance(name):
    faces = meshes.ALL[name]()[1]
    uses, balance = Counter(), Counter()
    for a, b, c in faces.tolist():
        for start, end in ((a, b), (b, c), (c, a)):
            if start != end:
                uses[min(start, end), max(start, end)] += 1
                balance[min(start, end), max(start, end)] += 1 if start < end else -1
    edges, result, *_ = find_edges(faces)
    assert list(map(tuple, edges.tolist())) == sorted(uses)
    assert result.tolist() == [balance[tuple(edge)] for edge in edges.tolist()]
