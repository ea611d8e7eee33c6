"""What clusters of caps leave out stays within the proven bounds, by brute force."""

import numpy as np
import pytest

from cutcell.graph.boundary import find_boundary
from cutcell.graph.caps import cap_holes
from cutcell.graph.clusters import ROOT, cluster
from cutcell.graph.view import NOTHING, gather, moved, view
from tests import meshes, naive


def confetti():
    """Small triangles that have nothing in common."""
    rng = np.random.default_rng(0)
    vertices = rng.uniform(0.2, 0.5, (300, 1, 3)) + rng.normal(0, 0.01, (300, 3, 3))
    return vertices.reshape(-1, 3), np.arange(900, dtype=np.int32).reshape(-1, 3)


def view_all(clusters, place, reach, tolerance):
    """View all caps, from scratch."""
    return view(clusters, np.array([ROOT]), NOTHING, tuple(place), reach, tolerance, 10.0)


SHAPES = meshes.OPEN | {"confetti": confetti}


@pytest.mark.parametrize("name", SHAPES)
def test_caps_close_the_mesh(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, find_boundary(faces))
    assert len(find_boundary(np.concatenate([faces, caps.faces])).loop) == 0
    assert all(
        len(set(caps.loop[a:b])) == b - a >= 3
        for a, b in zip(caps.start[:-1], caps.start[1:], strict=True)
    )


class Balls:
    """Fields in balls, to be checked all at once: the slow numbers take their time."""

    def __init__(self, caps, seed):
        self.caps, self.rng = caps, np.random.default_rng(seed)
        self.fields, self.offsets, self.places = [], [], []

    def add(self, place, reach, field, is_torn):
        """Remember a field, as far away as it holds."""
        if np.isfinite(field.error):
            offset = self.rng.normal(size=(20, 3))
            offset *= reach / np.linalg.norm(offset, axis=1, keepdims=True)
            self.fields.append((field.value, field.x, field.y, field.z, field.error, is_torn))
            self.offsets.append(offset)
            self.places.append(place + offset)

    def assert_right(self):
        """Check the fields against the caps' true winding numbers."""
        value, *slope, error, is_torn = np.array(self.fields).T[:, :, None]
        offset, places = np.array(self.offsets), np.array(self.places)
        covered = naive.winding_number(self.caps.vertices, self.caps.faces, places.reshape(-1, 3))
        found = value + sum(offset[:, :, k] * slope[k] for k in range(3))
        off = covered.reshape(found.shape) - found
        off -= np.where(is_torn, np.round(off), 0)
        assert (np.abs(off) <= error + 1e-9).all()


@pytest.mark.parametrize("name", SHAPES)
def test_view_is_right_within_its_error(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = cluster(caps)
    rng = np.random.default_rng(1)
    balls = Balls(caps, 3)
    for reach in (0.0, 0.003, 0.02, 0.1):
        for tolerance in (1e-2, 1e-4):
            for place in rng.uniform(0, 1, (25, 3)):
                balls.add(place, reach, *view_all(clusters, place, reach, tolerance))
    assert len(balls.fields) > 150
    balls.assert_right()


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_handed_down_is_right_within_its_error(name):
    """Balls within balls: each takes over the field of the larger one and its list."""
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = cluster(caps)
    rng = np.random.default_rng(2)
    balls = Balls(caps, 4)
    for place in rng.uniform(0, 1, (30, 3)):
        listed, end, field, reach = np.array([ROOT]), 1, NOTHING, 0.3
        begin = 0
        for closest in (0.5, 0.5, 0.7, 0.8):
            listed, last, field = gather(
                clusters, listed, begin, end, tuple(place), reach, closest, field
            )
            begin, end = end, last
            nearer = place + rng.uniform(-1, 1, 3) * reach / 8
            field = moved(field, tuple(place), tuple(nearer))
            place, reach = nearer, reach / 4
            mine = listed[begin:end]
            seen = view(clusters, mine, field, tuple(place), reach, 1e-2, 10.0)
            balls.add(place, reach, *seen)
    assert len(balls.fields) > 20
    balls.assert_right()


def test_far_clusters_are_not_halved_and_nearly_right():
    vertices, faces = confetti()
    caps = cap_holes(vertices, find_boundary(faces))
    (value, *_, error), is_torn = view_all(cluster(caps), (0.9, 0.9, 0.95), 0.0, 1e-3)
    expected = naive.winding_number(caps.vertices, caps.faces, np.array([[0.9, 0.9, 0.95]]))[0]
    assert 0 < error < 0.01
    assert not is_torn
    assert abs(value - expected) < error


def test_a_ball_that_a_cap_enters_is_torn():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = cluster(caps)
    middle = caps.vertices[caps.faces[0]].mean(axis=0)
    assert view_all(clusters, middle + 1e-3, 0.01, 1e-2)[1]
    assert not view_all(clusters, middle + 0.1, 0.01, 1e-2)[1]


def test_a_point_on_a_cap_is_not_decided_by_rounding():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, find_boundary(faces))
    spot = np.array([0.4, 0.35, 0.25]) @ caps.vertices[caps.faces[0]]
    assert view_all(cluster(caps), spot, 0.0, 1e-6)[0].error == np.inf
