"""Tests of exercise 3. Do not change them."""

import numpy as np
from stub import signed_crossings, winding_number

SQUARE = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])


def closed(corners):
    """Return the segments of a closed outline."""
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def star(rng, corners):
    """Return a random outline around the origin, counter-clockwise."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, corners))
    radii = rng.uniform(0.5, 1.5, corners)
    return closed(radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1))


INSIDE, OUTSIDE = np.array([[1.0, 1], [0.1, 1.9]]), np.array([[3.0, 1], [-1, -1], [1, 5]])


def test_a_square_has_one_inside_and_zero_outside():
    np.testing.assert_allclose(winding_number(closed(SQUARE), INSIDE), 1)
    np.testing.assert_allclose(winding_number(closed(SQUARE), OUTSIDE), 0, atol=1e-12)


def test_the_order_of_segments_does_not_matter():
    segments = closed(SQUARE)[[2, 0, 3, 1]]
    np.testing.assert_allclose(winding_number(segments, INSIDE), 1)


def test_clockwise_gives_minus_one():
    np.testing.assert_allclose(winding_number(closed(SQUARE[::-1]), INSIDE), -1)


def test_an_outline_that_runs_round_twice_gives_two():
    segments = np.concatenate([closed(SQUARE)] * 2)
    np.testing.assert_allclose(winding_number(segments, INSIDE), 2)


def test_a_hole_has_zero():
    hole = closed(0.5 + SQUARE[::-1] / 2)
    segments = np.concatenate([closed(SQUARE), hole])
    np.testing.assert_allclose(winding_number(segments, [[1, 1], [0.25, 1]]), [0, 1], atol=1e-12)


def test_one_segment_gives_its_angle():
    segment = np.array([[[1.0, -1], [1, 1]]])
    np.testing.assert_allclose(winding_number(segment, [[0.0, 0]]), [0.25])
    np.testing.assert_allclose(winding_number(segment, [[2.0, 0]]), [-0.25])


def test_a_missing_side_leaves_a_fraction():
    value = winding_number(closed(SQUARE)[:3], np.array([[1.0, 1]]))
    np.testing.assert_allclose(value, [0.75])


def test_crossings_count_up_and_down():
    assert signed_crossings(closed(SQUARE), np.array([1.0, 0.9])) == 1
    assert signed_crossings(closed(SQUARE), np.array([-1.0, 0.9])) == 0
    assert signed_crossings(closed(SQUARE[::-1]), np.array([1.0, 0.9])) == -1
    assert signed_crossings(closed(SQUARE), np.array([9.0, 0.9])) == 0


def test_a_ray_through_a_corner_is_counted_once():
    diamond = closed(np.array([[0.0, -1], [1, 0], [0, 1], [-1, 0]]))
    assert signed_crossings(diamond, np.array([0.0, 0])) == 1
    assert signed_crossings(diamond, np.array([-2.0, 0])) == 0
    assert signed_crossings(diamond, np.array([-2.0, 1])) == 0


def test_both_agree_on_closed_outlines():
    rng = np.random.default_rng(4)
    for _ in range(20):
        segments = np.concatenate([star(rng, 9), star(rng, 7)[:, ::-1], star(rng, 5)])
        points = rng.uniform(-1.6, 1.6, (30, 2))
        counted = [signed_crossings(segments, point) for point in points]
        np.testing.assert_allclose(winding_number(segments, points), counted, atol=1e-9)
