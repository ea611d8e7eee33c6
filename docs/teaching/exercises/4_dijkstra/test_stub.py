"""Tests of exercise 4. Do not change them."""

import numpy as np
import pytest
from stub import dijkstra, leak

# 0 -1- 1 -1- 2 -1- 3, a shortcut 0 -2.5- 3, and 4 apart.
EDGES, LENGTHS = np.array([[0, 1], [1, 2], [2, 3], [0, 3]]), np.array([1.0, 1, 1, 2.5])


def relaxed(edges, lengths, sources, count):
    """Return distances by relaxing all edges until nothing changes."""
    distance = np.full(count, np.inf)
    for node, start in sources.items():
        distance[node] = start
    for _ in range(count):
        for (a, b), length in zip(edges, lengths, strict=True):
            distance[a] = min(distance[a], distance[b] + length)
            distance[b] = min(distance[b], distance[a] + length)
    return distance


def test_distances_from_one_source():
    distance, _ = dijkstra(EDGES, LENGTHS, {0: 0.0}, 5)
    np.testing.assert_allclose(distance, [0, 1, 2, 2.5, np.inf])


def test_edges_lead_both_ways():
    distance, _ = dijkstra(EDGES, LENGTHS, {3: 0.0}, 5)
    np.testing.assert_allclose(distance, [2.5, 2, 1, 0, np.inf])


def test_nodes_are_settled_by_distance():
    _, order = dijkstra(EDGES, LENGTHS, {0: 0.0}, 5)
    assert list(order) == [0, 1, 2, 3]


def test_the_nearest_source_counts():
    distance, _ = dijkstra(EDGES, LENGTHS, {0: 0.0, 3: 0.25}, 5)
    np.testing.assert_allclose(distance, [0, 1, 1.25, 0.25, np.inf])


def test_sources_begin_with_their_distances():
    distance, _ = dijkstra(EDGES, LENGTHS, {1: 0.5, 2: 0.75}, 5)
    np.testing.assert_allclose(distance, [1.5, 0.5, 0.75, 1.75, np.inf])


def test_a_source_may_be_nearer_by_way_of_another():
    distance, order = dijkstra(EDGES, LENGTHS, {0: 0.0, 1: 9.0}, 5)
    np.testing.assert_allclose(distance[:2], [0, 1])
    assert sorted(order) == [0, 1, 2, 3]


def test_edges_of_no_length_cost_nothing():
    distance, _ = dijkstra(EDGES, np.zeros(4), {2: 0.5}, 5)
    np.testing.assert_allclose(distance, [0.5] * 4 + [np.inf])


@pytest.mark.parametrize("seed", range(5))
def test_it_agrees_with_relaxing_all_edges(seed):
    rng = np.random.default_rng(seed)
    edges, lengths = rng.integers(0, 40, (70, 2)), rng.uniform(0, 1, 70)
    sources = {int(node): float(rng.uniform()) for node in rng.integers(0, 40, 3)}
    distance, order = dijkstra(edges, lengths, sources, 40)
    np.testing.assert_allclose(distance, relaxed(edges, lengths, sources, 40))
    assert sorted(order) == np.flatnonzero(np.isfinite(distance)).tolist()
    assert (np.diff(distance[list(order)]) >= 0).all()


def test_a_long_chain_takes_a_moment_only():
    count = 20_000
    edges = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    distance, _ = dijkstra(edges, np.ones(count - 1), {0: 0.0}, count)
    np.testing.assert_allclose(distance, np.arange(count))


def test_the_leak_adds_the_branch_and_averages_the_region():
    weights = np.array([[0.5, 0.25, 0.25], [0.0, 1, 0], [0.2, 0.2, 0.6]])
    assert leak(weights, [1, 2], np.array([True, False, True])) == pytest.approx(0.65)
    assert leak(weights, [0], np.array([False, True, False])) == pytest.approx(0)
