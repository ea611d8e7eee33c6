"""Tests of exercise 5. Do not change them."""

import numpy as np
import pytest
from stub import l1, motion_errors, root_mean_square, skin

VERTICES = np.array([[1.0, 0, 0], [0, 2, 0]])
ARTIST = np.array([[1.0, 0], [0.5, 0.5]])
OTHER = np.array([[0.75, 0.25], [0.5, 0.5]])


def lifted(height):
    """Return matrices of two joints, of which the second moves up."""
    matrices = np.array([np.eye(4), np.eye(4)])
    matrices[1, 1, 3] = height
    return matrices


def test_skin_blends_the_places():
    expected = [[1, 1, 0], [0, 4, 0]]
    np.testing.assert_allclose(skin(VERTICES, OTHER, lifted(4)), expected)


def test_equal_weights_have_no_l1():
    assert l1(ARTIST, ARTIST) == 0


def test_l1_is_the_mean_over_vertices():
    assert l1(OTHER, ARTIST) == pytest.approx(0.25)


def test_opposite_weights_have_the_largest_l1():
    assert l1(np.eye(2), np.eye(2)[::-1]) == pytest.approx(2)


def test_l1_counts_both_signs():
    assert l1(ARTIST, OTHER) == pytest.approx(l1(OTHER, ARTIST))


def test_errors_are_distances_of_posed_vertices():
    motion = np.array([lifted(0), lifted(4), lifted(-8)])
    errors = motion_errors(VERTICES, OTHER, ARTIST, motion)
    assert errors.shape == (3, 2)
    np.testing.assert_allclose(errors, [[0, 0], [1, 0], [2, 0]])


def test_without_motion_all_weights_are_right():
    errors = motion_errors(VERTICES, OTHER, ARTIST, np.array([lifted(0)] * 4))
    np.testing.assert_allclose(errors, 0)


def test_the_root_of_the_mean_square():
    assert root_mean_square(np.array([[3.0, 0], [4, 0]])) == pytest.approx(2.5)
    assert root_mean_square(np.full(7, 2.0)) == pytest.approx(2)


def test_one_large_error_outweighs_many_small_ones():
    many, one = np.full(100, 1.0), np.zeros(100)
    one[0] = 100
    assert one.mean() == many.mean()
    assert root_mean_square(one) > 9 * root_mean_square(many)
