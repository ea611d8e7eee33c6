"""Tests of exercise 2. Do not change them."""

import numpy as np
from stub import distance_to_segment, falloff, straight_distances

START, END = np.array([0.0, 0, 0]), np.array([2.0, 0, 0])


def test_beside_the_segment_the_distance_is_perpendicular():
    points = np.array([[1.0, 3, 0], [0.5, 0, -2], [2, 0, 0]])
    np.testing.assert_allclose(distance_to_segment(points, START, END), [3, 2, 0])


def test_beyond_its_ends_the_distance_is_to_the_end():
    points = np.array([[-3.0, 4, 0], [5, 0, 4]])
    np.testing.assert_allclose(distance_to_segment(points, START, END), [5, 5])


def test_a_bone_of_no_length_is_a_point():
    points = np.array([[0.0, 3, 4], [1, 1, 1]])
    distances = distance_to_segment(points, END / 2, END / 2)
    np.testing.assert_allclose(distances, [np.sqrt(26), np.sqrt(2)])


def test_the_distance_equals_the_least_of_many_samples():
    rng = np.random.default_rng(2)
    points, a, b = rng.normal(size=(40, 3)), rng.normal(size=3), rng.normal(size=3)
    samples = a + np.linspace(0, 1, 4001)[:, None] * (b - a)
    expected = np.linalg.norm(points[:, None] - samples, axis=2).min(axis=1)
    np.testing.assert_allclose(distance_to_segment(points, a, b), expected, atol=1e-3)


def test_the_nearest_bone_of_a_joint_counts():
    starts, ends = np.array([[0.0, 0, 0], [9, 0, 0], [0, 5, 0]]), np.array([[1.0, 0, 0], [8, 0, 0],
                                                                           [0, 6, 0]])  # fmt: skip
    points = np.array([[0.0, 1, 0], [8.5, 2, 0]])
    distances = straight_distances(points, starts, ends, np.array([0, 0, 2]), 3)
    assert distances.shape == (2, 3)
    np.testing.assert_allclose(distances[:, 0], [1, 2])
    np.testing.assert_allclose(distances[:, 2], [4, np.hypot(8.5, 3)])
    assert np.isinf(distances[:, 1]).all()


def test_rows_sum_to_one():
    weights = falloff(np.random.default_rng(3).uniform(0, 2, (50, 6)), 2)
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    assert (weights >= 0).all()


def test_weights_are_those_of_the_formula():
    np.testing.assert_allclose(falloff(np.array([[1.0, 2]]), 2), [[0.8, 0.2]])
    np.testing.assert_allclose(falloff(np.array([[1.0, 2]]), 3), [[8 / 9, 1 / 9]])


def test_a_vertex_on_a_bone_has_finite_weights():
    np.testing.assert_allclose(falloff(np.array([[0.0, 0, 0.002]]), 1), [[0.4, 0.4, 0.2]])


def test_an_infinite_distance_gives_no_weight():
    np.testing.assert_allclose(falloff(np.array([[np.inf, 0.5]]), 2), [[0, 1]])
