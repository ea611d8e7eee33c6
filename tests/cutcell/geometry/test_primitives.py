"""Primitives give the same in numpy and in kernels, and as plain formulas do."""

import numpy as np
import pytest

from cutcell.geometry.edges import find_edges
from cutcell.geometry.laplacian import vertex_normals
from cutcell.geometry.segments import closest_on_segment, distance_to_segment
from cutcell.geometry.triangles import areas, face_edges, normals, unit_normals
from cutcell.geometry.vectors import length, segment_fraction, triangle_normal
from cutcell.runtime.compiled import compiled


@compiled
def fractions(start, end, points):
    result = np.empty(len(points))
    for k in range(len(points)):
        result[k] = segment_fraction(start[k], end[k], points[k])
    return result


@compiled
def double_areas(corners):
    result = np.empty(len(corners))
    for k in range(len(corners)):
        result[k] = length(triangle_normal(corners[k, 0], corners[k, 1], corners[k, 2]))
    return result


def test_the_closest_point_on_a_segment_is_closer_than_all_others():
    rng = np.random.default_rng(0)
    points, start, end = rng.normal(size=(3, 50, 3))
    end[:5] = start[:5]  # segments that are points
    closest, fraction = closest_on_segment(points, start, end)
    np.testing.assert_allclose(fractions(start, end, points), fraction, atol=1e-12)
    distance = distance_to_segment(points, start, end)
    np.testing.assert_allclose(np.linalg.norm(points - closest, axis=1), distance, atol=1e-12)
    for t in np.linspace(0, 1, 11):
        others = start + t * (end - start)
        assert (np.linalg.norm(points - others, axis=1) >= distance - 1e-12).all()


def test_normals_and_areas_are_those_of_the_right_angled_triangle():
    corners = np.array([[[0.0, 0, 0], [3, 0, 0], [0, 4, 0]], [[1, 1, 1]] * 3])
    np.testing.assert_array_equal(normals(corners), [[0, 0, 12], [0, 0, 0]])
    np.testing.assert_array_equal(unit_normals(corners), [[0, 0, 1], [0, 0, 0]])
    np.testing.assert_array_equal(areas(corners), [6, 0])
    np.testing.assert_array_equal(double_areas(corners), [12, 0])
    faces = np.array([[0, 1, 2]], np.int32)
    np.testing.assert_array_equal(vertex_normals(corners[0], faces), [[0, 0, 1]] * 3)


@pytest.mark.parametrize("seed", range(3))
def test_edges_of_faces_are_those_of_the_mesh(seed):
    faces = np.random.default_rng(seed).integers(0, 9, (20, 3)).astype(np.int32)
    edges = np.unique(face_edges(faces), axis=0)
    np.testing.assert_array_equal(edges[edges[:, 0] < edges[:, 1]], find_edges(faces).edges)
