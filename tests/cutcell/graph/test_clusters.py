"""What clusters of caps leave out stays within the proven bounds, by brute force."""

import numpy as np
import pytest

from cutcell.graph.boundary import find_boundary
from cutcell.graph.caps import cap_holes
from cutcell.graph.clusters import cluster, view
from tests import meshes, naive


def confetti():
    """Small triangles that have nothing in common."""
    rng = np.random.default_rng(0)
    vertices = rng.uniform(0.2, 0.5, (300, 1, 3)) + rng.normal(0, 0.01, (300, 3, 3))
    return vertices.reshape(-1, 3), np.arange(900, dtype=np.int32).reshape(-1, 3)


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


@pytest.mark.parametrize("name", SHAPES)
def test_view_is_right_within_its_error(name):
    vertices, faces = SHAPES[name]()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = cluster(caps)
    rng = np.random.default_rng(1)
    compared = 0
    for reach in (0.0, 0.003, 0.02, 0.1):
        for tolerance in (1e-2, 1e-4):
            for place in rng.uniform(0, 1, (25, 3)):
                value, gradient, error, is_torn = view(
                    clusters, tuple(place), reach, tolerance, 10.0
                )
                if not np.isfinite(error):
                    continue
                offset = rng.normal(size=(20, 3))
                offset *= reach / np.linalg.norm(offset, axis=1, keepdims=True)
                covered = naive.winding_number(caps.vertices, caps.faces, place + offset)
                off = covered - value - offset @ np.array(gradient)
                off -= np.round(off) if is_torn else 0
                assert np.abs(off).max() <= error + 1e-9
                compared += 1
    assert compared > 150


def test_far_clusters_are_not_halved_and_nearly_right():
    vertices, faces = confetti()
    caps = cap_holes(vertices, find_boundary(faces))
    value, _, error, is_torn = view(cluster(caps), (0.9, 0.9, 0.95), 0.0, 1e-3, 10.0)
    expected = naive.winding_number(caps.vertices, caps.faces, np.array([[0.9, 0.9, 0.95]]))[0]
    assert 0 < error < 0.01
    assert not is_torn
    assert abs(value - expected) < error


def test_a_ball_that_a_cap_enters_is_torn():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = cluster(caps)
    middle = caps.vertices[caps.faces[0]].mean(axis=0)
    assert view(clusters, tuple(middle + 1e-3), 0.01, 1e-2, 10.0)[3]
    assert not view(clusters, tuple(middle + 0.1), 0.01, 1e-2, 10.0)[3]


def test_a_point_on_a_cap_is_not_decided_by_rounding():
    vertices, faces = meshes.open_box()
    caps = cap_holes(vertices, find_boundary(faces))
    spot = np.array([0.4, 0.35, 0.25]) @ caps.vertices[caps.faces[0]]
    assert view(cluster(caps), tuple(spot), 0.0, 1e-6, 0.5)[2] == np.inf
