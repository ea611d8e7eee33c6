"""Errors of the treecode stay within the proven bounds, by brute force."""

import numpy as np
import pytest

from cutcell.graph.winding.boundary import find_boundary
from cutcell.graph.winding.treecode.caps import cap_holes, smallest_caps
from cutcell.graph.winding.treecode.clusters import ROOT, build_tree
from cutcell.graph.winding.treecode.expansion import (
    ERROR,
    EXPANSION_SIZE,
    add_clusters,
    add_far_clusters,
    evaluate,
    translate,
    variation,
)
from cutcell.graph.winding.treecode.solid_angles import (
    CLEAR,
    POINTS_TOGETHER,
    SIMD_WIDTH,
    VALUE,
    WORKSPACE,
    caps_winding_numbers,
)
from tests import meshes, naive


def confetti():
    """Small triangles that have nothing in common."""
    rng = np.random.default_rng(0)
    vertices = rng.uniform(0.2, 0.5, (300, 1, 3)) + rng.normal(0, 0.01, (300, 3, 3))
    return vertices.reshape(-1, 3), np.arange(900, dtype=np.int32).reshape(-1, 3)


def expand(clusters, place, reach, tolerance):
    """Return the local expansion of all caps in a ball."""
    far, near = np.zeros(EXPANSION_SIZE), np.empty(len(clusters.start) - 1, np.int32)
    ball = tuple(place), reach
    count = add_far_clusters(clusters, np.array([ROOT], np.int32), far, near, *ball)
    add_clusters(clusters, near[:count], far, *ball, tolerance)
    return far


def winding_of_caps(clusters, places, tolerance):
    """Return the caps' winding number at places in a ball, and a bound of the error."""
    count = -(-len(places) // SIMD_WIDTH) * SIMD_WIDTH
    points = np.empty(WORKSPACE)
    points.reshape(-1, POINTS_TOGETHER)[:3, :count] = places[
        np.minimum(np.arange(count), len(places) - 1)
    ].T
    centre = places.mean(axis=0)
    reach = np.linalg.norm(places - centre, axis=1).max()
    ball = tuple(centre), reach
    every = np.array([ROOT], np.int32)
    error = caps_winding_numbers(clusters, every, *ball, tolerance, points, count)
    value, clear = (points[row : row + len(places)] for row in (VALUE, CLEAR))
    return value, np.where(clear > 0, error, np.inf)


SHAPES = meshes.OPEN | {"confetti": confetti}


@pytest.mark.parametrize("cap", [cap_holes, smallest_caps])
@pytest.mark.parametrize("name", SHAPES)
def test_caps_close_the_mesh(name, cap):
    vertices, faces = SHAPES[name]()
    caps = cap(vertices, find_boundary(faces))
    assert len(find_boundary(np.concatenate([faces, caps.faces])).loop) == 0
    assert all(
        len(set(caps.loop[a:b])) == b - a >= 3
        for a, b in zip(caps.start[:-1], caps.start[1:], strict=True)
    )


def test_rims_along_each_other_are_joined_by_strips():
    """A tube in a tube, like a leg in trousers: the gap between them is narrow, the holes wide."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    rings = [r * ring + (0.5, 0.5, z) for r in (0.198, 0.2) for z in (0.2, 0.8)]
    i, j = np.arange(24), np.roll(np.arange(24), -1)
    tube = np.concatenate([np.stack([i, j, j + 24], axis=1), np.stack([i, j + 24, i + 24], axis=1)])
    vertices, faces = np.concatenate(rings), np.concatenate([tube[:, ::-1], tube + 48])
    boundary = find_boundary(faces.astype(np.int32))
    caps = smallest_caps(vertices, boundary)
    a, b, c = (caps.vertices[corner] for corner in caps.faces.T)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    across = 24 * np.sin(2 * np.pi / 24) / 2 * (0.2**2 - 0.198**2)
    np.testing.assert_allclose(area, 2 * across)
    assert len(find_boundary(np.concatenate([faces, caps.faces]).astype(np.int32)).loop) == 0


@pytest.mark.parametrize("name", SHAPES)
def test_expansion_is_right_within_its_error(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = build_tree(caps)
    rng = np.random.default_rng(1)
    fields, ways, places = [], [], []  # evaluated at once by the slow oracle
    for reach in (0.003, 0.02, 0.1):
        for tolerance in (1e-2, 1e-4):
            for place in rng.uniform(0, 1, (40, 3)):
                field = expand(clusters, place, reach, tolerance)
                if field[ERROR] <= 0.5:
                    way = rng.normal(size=(20, 3))
                    way *= reach / np.linalg.norm(way, axis=1, keepdims=True)
                    fields.append(field)
                    ways.append(way)
                    places.append(place + way)
    assert len(fields) > 100
    expected = naive.winding_number(caps.vertices, caps.faces, np.concatenate(places))
    for field, way, known in zip(fields, ways, expected.reshape(-1, 20), strict=True):
        off = known - evaluate.py_func(field, *way.T)
        assert np.abs(off).max() <= field[ERROR] + 1e-9


@pytest.mark.parametrize("name", SHAPES)
def test_winding_number_of_caps_is_right_within_its_error(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = build_tree(caps)
    rng = np.random.default_rng(2)
    for count, size in ((1, 0.0), (5, 0.02), (16, 0.2)):
        balls = rng.uniform(0, 1, (60 // count, 1, 3)) + rng.normal(
            0, size, (60 // count, count, 3)
        )
        expected = naive.winding_number(caps.vertices, caps.faces, balls.reshape(-1, 3))
        for tolerance in (1e-1, 1e-3, 1e-6, 0.0):
            seen = [winding_of_caps(clusters, places, tolerance) for places in balls]
            value, error = np.concatenate(seen, axis=1)
            is_clear = np.isfinite(error)
            assert is_clear.mean() > 0.8
            assert (np.abs(value - expected) <= error + 1e-9)[is_clear].all()


def test_the_bound_is_no_more_than_it_must_be():
    """Far from many small triangles, it is loose by what they could do at worst, not by more."""
    vertices, faces = confetti()
    caps = cap_holes(vertices, find_boundary(faces))
    place = np.array([0.9, 0.9, 0.95])
    value, error = (x[0] for x in winding_of_caps(build_tree(caps), place[None], 1e-3))
    expected = naive.winding_number(caps.vertices, caps.faces, place[None])[0]
    assert 0 < error < 0.004
    assert abs(value - expected) < error


def test_a_translated_expansion_is_the_same_function():
    rng = np.random.default_rng(3)
    field, way, half = rng.normal(size=EXPANSION_SIZE), rng.normal(size=3), 0.3
    expected = evaluate(field, *np.add(way, [0.1, -0.2, 0.3]))
    bound = variation(field, half)
    inside = rng.uniform(-half, half, (200, 3))
    assert (np.abs(evaluate.py_func(field, *inside.T) - field[0]) <= bound).all()
    translate(field, *way)
    np.testing.assert_allclose(evaluate(field, 0.1, -0.2, 0.3), expected)


def test_an_expansion_in_a_ball_crossed_by_a_cap_decides_nothing():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = build_tree(caps)
    middle = caps.vertices[caps.faces[0]].mean(axis=0)
    assert expand(clusters, middle + 0.1, 0.01, 1e-2)[ERROR] < 0.5
    for place in (middle + 1e-3, caps.vertices[caps.loop[0]] + 1e-3):
        assert expand(clusters, place, 0.01, 1e-2)[ERROR] == np.inf


def test_a_point_on_a_cap_is_not_decided_by_rounding():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, find_boundary(faces))
    spot = np.array([0.4, 0.35, 0.25]) @ caps.vertices[caps.faces[0]]
    assert winding_of_caps(build_tree(caps), spot[None], 1e-6)[1] == np.inf
