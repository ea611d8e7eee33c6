"""Closest points of triangles."""

import numpy as np

from cutcell_app.editing.symmetry.closest import closest_on_triangle


def test_the_closest_point_of_a_triangle_is_that_of_a_dense_sample():
    random = np.random.default_rng(5)
    corners = random.normal(size=(60, 3, 3))
    corners[0, 2] = corners[0, 1]  # without area
    points = random.normal(size=(60, 3))
    gap, shares = closest_on_triangle(points, corners)
    np.testing.assert_allclose(shares.sum(axis=1), 1)
    assert shares.min() > -1e-12
    places = np.einsum("nk,nkc->nc", shares, corners)
    np.testing.assert_allclose(np.linalg.norm(points - places, axis=1), gap, atol=1e-12)
    a, b = (axis.ravel() for axis in np.mgrid[0:1:101j, 0:1:101j])
    inside = a + b <= 1 + 1e-12
    samples = np.stack([1 - a - b, a, b], axis=1)[inside]
    every = np.einsum("sk,nkc->nsc", samples, corners)
    least = np.linalg.norm(every - points[:, None], axis=2).min(axis=1)
    assert (gap <= least + 1e-12).all()
    assert (gap >= least - 0.05).all()
