"""True distances are true: closed forms by sampling, the convex problem where it has one."""

import numpy as np
import pytest
import trimesh

from cutcell_lab.benchmarks import truth

STRAIGHT = truth.Tube(
    lambda t: (
        np.stack([t, np.zeros_like(t), np.zeros_like(t)], axis=-1),
        np.broadcast_to([0.0, 1.0, 0.0], (*np.shape(t), 3)),
    ),
    0.1,
)


def test_around_the_edge_equals_a_search_over_its_points():
    rng = np.random.default_rng(0)
    points = rng.uniform([0, 0, 0], [1, 1, 0.25], (400, 3))
    points = points[(points[:, :2] < 0.3).any(axis=1)]
    source = np.array([0.9, 0.1, 0.1])
    edge = np.column_stack([np.full((2001, 2), 0.3), np.linspace(0, 0.25, 2001)])
    over = np.linalg.norm(edge - source, axis=1)[None] + np.linalg.norm(
        points[:, None] - edge[None], axis=2
    )
    share = np.linspace(0, 1, 200)[:, None, None]
    between = source + share * (points - source)
    leaves = (between[..., :2] > 0.3).all(axis=2).any(axis=0)
    direct = np.linalg.norm(points - source, axis=1)
    expected = np.where(leaves, over.min(axis=1), direct)
    assert 20 < leaves.sum() < len(points) - 20
    np.testing.assert_allclose(truth.around_edge(source, points), expected, atol=1e-4)


def test_in_a_straight_tube_paths_are_straight():
    rng = np.random.default_rng(1)
    begin, end = (
        np.column_stack([np.full(20, t), rng.uniform(-0.06, 0.06, (20, 2))]) for t in (0.0, 2.0)
    )
    result = truth.shortest_through_discs(STRAIGHT, begin, end, 16, 500)
    np.testing.assert_allclose(result, np.linalg.norm(end - begin, axis=1), rtol=1e-9)


def test_around_a_torus_paths_touch_its_inner_side():
    tube = truth.Tube(truth._circle, 0.14)
    inner = 0.35 - 0.14
    begin, end = np.array([[0.0, 0.0, 0.0]]), np.array([[np.pi, 0.0, 0.0]])
    # In the plane of the circle: a tangent, an arc, a tangent.
    free = np.arccos(inner / 0.35)
    expected = 2 * np.sqrt(0.35**2 - inner**2) + inner * (np.pi - 2 * free)
    result = truth.shortest_through_discs(tube, begin, end)
    assert result[0] == pytest.approx(expected, rel=3e-4)
    finer = truth.shortest_through_discs(tube, begin, end, 4 * truth.SECTIONS, 4 * truth.STEPS)
    assert abs(finer[0] - expected) < 0.2 * abs(result[0] - expected)


@pytest.mark.parametrize("name", ["ball", "box", "L-bar"])
def test_shapes_are_closed_and_hold_their_sources(name):
    shape = truth.SHAPES[name]()
    mesh = trimesh.Trimesh(shape.mesh.vertices, shape.mesh.faces, process=False)
    assert mesh.is_watertight
    assert mesh.volume > 0
    assert shape.distance.shape == (len(shape.sources), len(shape.targets))
    straight = np.linalg.norm(shape.mesh.vertices[shape.targets] - shape.sources[:, None], axis=2)
    assert (shape.distance >= straight - 1e-12).all()


def test_tubes_are_closed():
    tube = truth.Tube(truth._spiral, 0.035)
    vertices, faces, *_ = tube.mesh(*truth.SPIRAL, 60, 8, closed=False)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    assert mesh.is_watertight
    assert mesh.volume > 0
