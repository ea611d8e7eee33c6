"""Tests of exercise 1. Do not change them."""

import numpy as np
from stub import rotation_about, skin

POINTS = np.array([[0.0, 0, 0], [1, 2, 3], [-4, 0.5, 2]])


def translation(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def test_a_rotation_moves_a_point_counter_clockwise():
    matrix = rotation_about(np.zeros(3), 90)
    assert matrix.shape == (4, 4)
    np.testing.assert_allclose(matrix @ [1, 0, 5, 1], [0, 1, 5, 1], atol=1e-12)


def test_the_axis_of_a_rotation_stays():
    matrix = rotation_about(np.array([1.0, 2, 3]), 75)
    np.testing.assert_allclose(matrix @ [1, 2, -7, 1], [1, 2, -7, 1], atol=1e-12)


def test_a_point_beside_the_axis_turns_around_it():
    matrix = rotation_about(np.array([1.0, 1, 0]), 180)
    np.testing.assert_allclose(matrix @ [3, 1, 0, 1], [-1, 1, 0, 1], atol=1e-12)


def test_identities_leave_the_rest_pose():
    weights = np.array([[0.2, 0.8], [1, 0], [0.5, 0.5]])
    np.testing.assert_allclose(skin(POINTS, weights, np.array([np.eye(4)] * 2)), POINTS)


def test_a_vertex_of_one_joint_follows_it_rigidly():
    matrices = np.array([rotation_about(np.zeros(3), 90), translation(0, 0, 1)])
    weights = np.array([[0.0, 1], [1, 0], [0, 1]])
    expected = [[0, 0, 1], [-2, 1, 3], [-4, 0.5, 3]]
    np.testing.assert_allclose(skin(POINTS, weights, matrices), expected, atol=1e-12)


def test_weights_blend_the_places():
    matrices = np.array([np.eye(4), translation(4, 0, -8)])
    weights = np.tile([0.75, 0.25], (3, 1))
    np.testing.assert_allclose(skin(POINTS, weights, matrices), POINTS + np.array([1, 0, -2]))


def test_two_opposite_rotations_collapse_a_vertex_to_the_axis():
    matrices = np.array([rotation_about(np.zeros(3), angle) for angle in (90, -90)])
    posed = skin(np.array([[1.0, 0, 2]]), np.array([[0.5, 0.5]]), matrices)
    np.testing.assert_allclose(posed, [[0, 0, 2]], atol=1e-12)


def test_weights_are_not_normalised():
    posed = skin(POINTS, np.full((3, 1), 0.9), np.eye(4)[None])
    np.testing.assert_allclose(posed, 0.9 * POINTS)


def test_it_agrees_with_two_loops():
    rng = np.random.default_rng(1)
    vertices, weights = rng.normal(size=(30, 3)), rng.dirichlet(np.ones(5), 30)
    matrices = rng.normal(size=(5, 4, 4))
    matrices[:, 3] = 0, 0, 0, 1
    expected = np.zeros((30, 3))
    for n in range(30):
        for j in range(5):
            expected[n] += weights[n, j] * (matrices[j] @ [*vertices[n], 1])[:3]
    np.testing.assert_allclose(skin(vertices, weights, matrices), expected)
