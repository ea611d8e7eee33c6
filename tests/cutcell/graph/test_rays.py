"""Rays meet triangles exactly as fractions say, and leave closed surfaces as they enter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutcell.geometry.weld import weld
from cutcell.graph.rays import cast_rays
from tests import meshes, naive


def as_list(crossings, resolution):
    ray = np.repeat(np.arange(resolution**2), np.diff(crossings.start))
    return list(
        zip(
            ray // resolution,
            ray % resolution,
            crossings.position,
            crossings.sign,
            crossings.triangle,
            strict=True,
        )
    )


def check_against_fractions(vertices, faces, resolution, axis):
    vertices, index = weld(vertices, 0.0)
    faces = index[faces]
    result = as_list(cast_rays(vertices, faces, resolution, axis), resolution)
    expected = naive.rays(vertices, faces, resolution, axis)
    assert sorted((i, j, s, t) for i, j, _, s, t in result) == sorted(
        (i, j, s, t) for i, j, _, s, t in expected
    )
    where = {(i, j, t): p for i, j, p, _, t in expected}
    for i, j, position, _, t in result:
        assert position == pytest.approx(where[i, j, t], abs=1e-12)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("name", meshes.ALL)
def test_rays_equal_exact_arithmetic(name, axis):
    check_against_fractions(*meshes.ALL[name](), 8, axis)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.integers(0, 2), st.sampled_from([4, 8]))
def test_rays_through_edges_and_vertices(seed, axis, resolution):
    # R is a power of two: corners and rays meet exactly, also in floating point.
    check_against_fractions(*meshes.grid_soup(seed, 8), resolution, axis)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.integers(0, 2))
def test_random_soups(seed, axis):
    check_against_fractions(*meshes.random_soup(seed), 6, axis)


@pytest.mark.parametrize("resolution", [2, 3, 8, 33, 64])
@pytest.mark.parametrize("name", meshes.CLOSED)
def test_a_ray_leaves_a_closed_mesh_as_often_as_it_enters(name, resolution):
    vertices, faces = meshes.CLOSED[name]()
    for axis in range(3):
        crossings = cast_rays(vertices, faces, resolution, axis)
        assert (np.diff(crossings.start) % 2 == 0).all()
        balance = np.concatenate([[0], np.cumsum(crossings.sign, dtype=int)])[crossings.start]
        assert (balance == 0).all()


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.integers(2, 20))
def test_rounding_never_opens_a_closed_mesh(seed, resolution):
    # A closed surface of random shape, folded through itself and rotated, whose corners
    # were pulled to within a few units in the last place of lattice lines.
    rng = np.random.default_rng(seed)
    vertices, faces = meshes.ball(1)
    vertices = rng.uniform(0.1, 0.9, vertices.shape)
    lines = (np.round(vertices * resolution - 0.5) + 0.5) / resolution
    pulled = rng.random(vertices.shape) < 0.5
    noise = 1 + rng.integers(-2, 3, vertices.shape) * np.finfo(float).eps
    vertices = np.where(pulled, lines * noise, vertices)
    for axis in range(3):
        crossings = cast_rays(vertices, faces, resolution, axis)
        assert (np.diff(crossings.start) % 2 == 0).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_crossings_ascend_and_enter_before_they_leave(axis):
    vertices, faces = meshes.two_boxes_that_touch()
    faces = np.tile(faces, (40, 1))  # enough layers for the long-ray path of the sort
    crossings = cast_rays(vertices, faces, 16, axis)
    for ray in np.flatnonzero(np.diff(crossings.start)):
        part = slice(crossings.start[ray], crossings.start[ray + 1])
        keys = list(
            zip(
                crossings.position[part],
                crossings.sign[part],
                crossings.triangle[part],
                strict=True,
            )
        )
        assert keys == sorted(keys)
