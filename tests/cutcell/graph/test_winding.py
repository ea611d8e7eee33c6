"""The winding number equals sums of solid angles, and libigl's, everywhere."""

import tracemalloc

import igl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutcell import MeshError, ParameterError, TriangleMesh, winding_number
from cutcell.geometry.weld import weld
from tests import meshes, naive


def off_surface(vertices, faces, points):
    """Leave out points on a triangle, and on the edges of triangles without area."""
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    solid = faces[np.linalg.norm(cross, axis=1) > 0].astype(np.int64)
    off = igl.point_mesh_squared_distance(points, vertices, solid)[0] > 1e-16
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        along, from_a = b - a, points[:, None] - a
        squared = np.maximum((along**2).sum(axis=1), 1e-300)
        travel = np.clip((from_a * along).sum(axis=2) / squared, 0, 1)
        nearest = from_a - travel[..., None] * along
        off &= ((nearest**2).sum(axis=2) > 1e-16).all(axis=1)
    return points[off]


@pytest.mark.parametrize("name", meshes.ALL)
def test_equals_solid_angles(name):
    vertices, faces = meshes.ALL[name]()
    points = np.random.default_rng(1).uniform(-0.2, 1.2, (400, 3))
    expected = naive.winding_number(vertices, faces, points)
    result = winding_number(TriangleMesh(vertices, faces), points)
    np.testing.assert_allclose(result, expected, atol=1e-12)


@pytest.mark.parametrize("name", meshes.ALL)
def test_equals_libigl(name):
    vertices, faces = meshes.ALL[name]()
    points = off_surface(vertices, faces, np.random.default_rng(2).uniform(0, 1, (200, 3)))
    expected = igl.winding_number(vertices, faces.astype(np.int64), points)
    result = winding_number(TriangleMesh(vertices, faces), points)
    np.testing.assert_allclose(result, expected, atol=1e-9)


@settings(max_examples=40)
@given(st.integers(0, 10**6))
def test_points_in_line_with_edges_and_vertices(seed):
    # Corners and points on one grid: rays ahead run through vertices and along edges.
    vertices, faces = meshes.grid_soup(seed)
    grid = (np.stack(np.meshgrid(*[np.arange(8)] * 3), -1).reshape(-1, 3) + 0.5) / 8
    if np.ptp(vertices[np.unique(faces)], axis=0).max() == 0:
        return
    points = off_surface(vertices, faces, grid)
    expected = naive.winding_number(vertices, faces, points)
    result = winding_number(TriangleMesh(vertices, faces), points)
    np.testing.assert_allclose(result, expected, atol=1e-9)


@pytest.mark.parametrize("name", ["box", "ball", "torus"])
def test_one_just_inside_zero_just_outside(name):
    vertices, faces = meshes.CLOSED[name]()
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    # Not the centroid: it would look along the edges of its neighbours on the box.
    spot = np.einsum("mij,i->mj", corners, [0.5, 0.3, 0.2])
    inside = winding_number(TriangleMesh(vertices, faces), spot - 1e-6 * normal)
    outside = winding_number(TriangleMesh(vertices, faces), spot + 1e-6 * normal)
    np.testing.assert_allclose(inside - outside, 1, atol=1e-9)
    np.testing.assert_allclose(inside, 1, atol=1e-9)


def test_units_do_not_matter():
    vertices, faces = meshes.ball_with_holes()
    points = np.random.default_rng(3).uniform(0, 1, (50, 3))
    once = winding_number(TriangleMesh(vertices, faces), points)
    scaled = winding_number(TriangleMesh(vertices * 256 + 1024, faces), points * 256 + 1024)
    np.testing.assert_allclose(scaled, once, atol=1e-9)


def test_split_vertices_are_welded():
    vertices, faces = meshes.ball()
    split = TriangleMesh(vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3))
    points = np.random.default_rng(4).uniform(0, 1, (50, 3))
    result = winding_number(split, points)
    np.testing.assert_array_equal(result, np.round(result))


def test_boundary_of_a_closed_mesh_is_empty_and_of_a_hole_its_rim():
    vertices, faces = meshes.box()
    index = weld(vertices)[1]
    assert len(meshes.boundary(index[faces]).loop) == 0
    rim = meshes.boundary(index[faces[2:]])
    assert rim.start.tolist() == [0, 4]
    assert len(np.unique(rim.loop)) == 4


def test_the_rim_of_copies_is_repeated():
    vertices, faces = meshes.box()
    opened, once = faces[2:], faces[[4]]
    rim = meshes.boundary(np.concatenate([np.tile(opened, (5, 1)), once]))
    assert len(rim.start) - 1 == 6
    points = np.random.default_rng(5).uniform(-0.2, 1.2, (50, 3))
    copies = np.concatenate([np.tile(opened, (5, 1)), once])
    expected = naive.winding_number(vertices, copies, points)
    result = winding_number(TriangleMesh(vertices, copies), points)
    np.testing.assert_allclose(result, expected, atol=1e-12)


@pytest.mark.parametrize("points", [np.zeros(3), np.zeros((2, 2)), [[0, 0, np.nan]]])
def test_points_of_another_shape_are_refused(points):
    with pytest.raises(ParameterError, match="points must"):
        winding_number(TriangleMesh(*meshes.box()), points)


def test_no_faces_no_number():
    with pytest.raises(MeshError, match="no faces"):
        TriangleMesh(np.zeros((3, 3)), np.zeros((0, 3), int))


def test_a_fan_takes_memory_in_proportion_to_its_faces():
    """Each of its triangles covers much of a grid."""
    n = 8000
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    vertices = np.concatenate([ring, [[0, 0, -0.5], [0, 0, 0.5]]])
    i, j = np.arange(n), (np.arange(n) + 1) % n
    faces = [np.stack([a, b, np.full(n, tip)], 1) for a, b, tip in ((j, i, n), (i, j, n + 1))]
    mesh = TriangleMesh(vertices, np.concatenate(faces))
    points = np.random.default_rng(0).uniform(-1, 1, (300, 3))
    height = 0.5 - np.abs(points[:, 2]) - 0.5 * np.hypot(points[:, 0], points[:, 1])
    tracemalloc.start()
    try:
        numbers = winding_number(mesh, points)
        assert tracemalloc.get_traced_memory()[1] < 1500 * len(mesh.faces)
    finally:
        tracemalloc.stop()
    off = np.abs(height) > 1e-3
    np.testing.assert_allclose(numbers[off], height[off] > 0, atol=1e-9)
