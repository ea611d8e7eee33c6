"""What clusters of caps leave out stays within the proven bounds, by brute force."""

import numpy as np
import pytest

from cutcell.graph.boundary import find_boundary
from cutcell.graph.caps import cap_holes
from cutcell.graph.clusters import ROOT, cluster
from cutcell.graph.cover import CLEAR, LANES, ROOM, VALUE, WIDTH, cover
from cutcell.graph.field import ERROR, SIZE, change, move, value_at
from cutcell.graph.view import set_apart, view
from tests import meshes, naive


def confetti():
    """Small triangles that have nothing in common."""
    rng = np.random.default_rng(0)
    vertices = rng.uniform(0.2, 0.5, (300, 1, 3)) + rng.normal(0, 0.01, (300, 3, 3))
    return vertices.reshape(-1, 3), np.arange(900, dtype=np.int32).reshape(-1, 3)


def view_all(clusters, place, reach, tolerance):
    """View all caps in a ball; those set apart as far first."""
    far, near = np.zeros(SIZE), np.empty(len(clusters.start) - 1, np.int32)
    ball = tuple(place), reach
    count = set_apart(clusters, np.array([ROOT], np.int32), far, near, *ball)
    is_torn = view(clusters, near[:count], far, *ball, tolerance)
    return far, is_torn


def covered(clusters, places, tolerance):
    """Return what caps cover of the view from places in a ball, and what that may leave out."""
    lanes = -(-len(places) // LANES) * LANES
    seen = np.empty(ROOM)
    seen.reshape(-1, WIDTH)[:3, :lanes] = places[np.minimum(np.arange(lanes), len(places) - 1)].T
    centre = places.mean(axis=0)
    reach = np.linalg.norm(places - centre, axis=1).max()
    ball = tuple(centre), reach
    error = cover(clusters, np.array([ROOT], np.int32), *ball, tolerance, seen, lanes)
    value, clear = (seen[row : row + len(places)] for row in (VALUE, CLEAR))
    return value, np.where(clear > 0, error, np.inf)


SHAPES = meshes.OPEN | {"confetti": confetti}


@pytest.mark.parametrize("name", SHAPES)
def test_caps_close_the_mesh(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, faces, find_boundary(faces))
    assert len(find_boundary(np.concatenate([faces, caps.faces])).loop) == 0
    assert all(
        len(set(caps.loop[a:b])) == b - a >= 3
        for a, b in zip(caps.start[:-1], caps.start[1:], strict=True)
    )


@pytest.mark.parametrize("name", SHAPES)
def test_view_is_right_within_its_error(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, faces, find_boundary(faces))
    clusters = cluster(caps)
    rng = np.random.default_rng(1)
    fields, ways, places = [], [], []  # asked about at once: the slow numbers take their time
    for reach in (0.003, 0.02, 0.1):
        for tolerance in (1e-2, 1e-4):
            for place in rng.uniform(0, 1, (30, 3)):
                field, is_torn = view_all(clusters, place, reach, tolerance)
                if field[ERROR] <= 0.5:
                    way = rng.normal(size=(20, 3))
                    way *= reach / np.linalg.norm(way, axis=1, keepdims=True)
                    fields.append((field, is_torn))
                    ways.append(way)
                    places.append(place + way)
    assert len(fields) > 100
    expected = naive.winding_number(caps.vertices, caps.faces, np.concatenate(places))
    for (field, is_torn), way, known in zip(fields, ways, expected.reshape(-1, 20), strict=True):
        off = known - value_at(field, *way.T)
        off -= np.round(off) if is_torn else 0
        assert np.abs(off).max() <= field[ERROR] + 1e-9


@pytest.mark.parametrize("name", SHAPES)
def test_what_points_see_is_right_within_its_error(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, faces, find_boundary(faces))
    clusters = cluster(caps)
    rng = np.random.default_rng(2)
    for count, size in ((1, 0.0), (5, 0.02), (16, 0.2)):
        balls = rng.uniform(0, 1, (60 // count, 1, 3)) + rng.normal(
            0, size, (60 // count, count, 3)
        )
        expected = naive.winding_number(caps.vertices, caps.faces, balls.reshape(-1, 3))
        for tolerance in (1e-1, 1e-3, 1e-6, 0.0):
            seen = [covered(clusters, places, tolerance) for places in balls]
            value, error = np.concatenate(seen, axis=1)
            is_clear = np.isfinite(error)
            assert is_clear.mean() > 0.8
            assert (np.abs(value - expected) <= error + 1e-9)[is_clear].all()


def test_the_bound_is_no_more_than_it_must_be():
    """Far from many small triangles, it is loose by what they could do at worst, not by more."""
    vertices, faces = confetti()
    caps = cap_holes(vertices, faces, find_boundary(faces))
    place = np.array([0.9, 0.9, 0.95])
    value, error = (x[0] for x in covered(cluster(caps), place[None], 1e-3))
    expected = naive.winding_number(caps.vertices, caps.faces, place[None])[0]
    assert 0 < error < 0.004
    assert abs(value - expected) < error


def test_a_field_is_the_same_seen_from_another_place():
    rng = np.random.default_rng(3)
    field, way, half = rng.normal(size=SIZE), rng.normal(size=3), 0.3
    expected = value_at(field, *np.add(way, [0.1, -0.2, 0.3]))
    bound = change(field, half)
    inside = rng.uniform(-half, half, (200, 3))
    assert (np.abs(value_at(field, *inside.T) - field[0]) <= bound).all()
    move(field, *way)
    np.testing.assert_allclose(value_at(field, 0.1, -0.2, 0.3), expected)


def test_a_ball_that_a_cap_enters_is_torn():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, faces, find_boundary(faces))
    clusters = cluster(caps)
    middle = caps.vertices[caps.faces[0]].mean(axis=0)
    assert view_all(clusters, middle + 1e-3, 0.01, 1e-2)[1]
    assert not view_all(clusters, middle + 0.1, 0.01, 1e-2)[1]


def test_a_point_on_a_cap_is_not_decided_by_rounding():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, faces, find_boundary(faces))
    spot = np.array([0.4, 0.35, 0.25]) @ caps.vertices[caps.faces[0]]
    assert covered(cluster(caps), spot[None], 1e-6)[1] == np.inf
