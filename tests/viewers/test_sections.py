"""Sections of meshes by planes, and values of fields between nodes."""

import numpy as np
import pytest
import trimesh

from cutcell import TriangleMesh, build_graph, winding_number
from cutcell_viewers.interpolation import interpolate
from cutcell_viewers.plane_section import plane_section

OBLIQUE = np.array([0.36, 0.48, 0.8])


@pytest.fixture(scope="module")
def beam():
    box = trimesh.creation.box(extents=(3.0, 0.6, 0.6)).subdivide_to_size(0.3)
    return TriangleMesh(box.vertices, box.faces)


@pytest.fixture(scope="module")
def graph(beam):
    return build_graph(beam, 16)


def area(points, faces):
    return np.linalg.norm(trimesh.triangles.cross(points[faces]), axis=1).sum() / 2


@pytest.mark.parametrize("normal", [*np.eye(3), OBLIQUE])
def test_a_section_is_the_meshs_own(beam, normal):
    origin = np.array([0.1, 0.02, -0.03])
    section = plane_section(beam, origin, normal, 40)
    points, faces, contour = section.above(0.5)
    away = (np.concatenate([points, section.outline.reshape(-1, 3)]) - origin) @ normal
    assert np.abs(away).max() < 1e-9
    half = trimesh.intersections.slice_faces_plane(beam.vertices, beam.faces, normal, origin)
    # The half is open at the section: there its vector area and the section's cancel.
    missing = trimesh.triangles.cross(half[0][half[1]]).sum(axis=0)
    assert area(points, faces) == pytest.approx(np.linalg.norm(missing) / 2, rel=1e-4)
    assert not len(contour)
    assert set(np.unique(section.winding)) == {0.0, 1.0}
    assert (trimesh.triangles.cross(points[faces]) @ normal > -1e-12).all()


def test_an_open_mesh_is_filled_by_its_winding_number(beam):
    corners = beam.vertices[beam.faces].mean(axis=1)
    hole = (np.abs(corners[:, 0]) < 0.2) & (corners[:, 1] == corners[:, 1].max())
    assert hole.any()
    opened = TriangleMesh(beam.vertices, beam.faces[~hole])
    plane = (np.zeros(3), np.array([0.0, 0.0, 1.0]))
    section = plane_section(opened, *plane, 40)
    assert ((section.winding > 0.05) & (section.winding < 0.95)).any()
    points, faces, contour = section.above(0.5)
    assert len(contour)
    assert np.abs(winding_number(opened, contour.reshape(-1, 3)) - 0.5).max() < 0.1
    closed = plane_section(beam, *plane, 40).above(0.5)
    assert area(points, faces) == pytest.approx(area(*closed[:2]), rel=0.1)


def test_a_plane_beside_the_body_has_no_section(beam):
    section = plane_section(beam, [0, 0, 3.0], [0, 0, 1.0], 40)
    assert not len(section.above(0.5)[1])
    assert not len(section.outline)


def test_a_linear_field_is_interpolated_exactly(graph):
    field = graph.nodes @ [0.5, 0.3, 0.2]
    rng = np.random.default_rng(3)
    low, high = graph.nodes.min(axis=0), graph.nodes.max(axis=0)
    points = low + rng.random((500, 3)) * (high - low)
    values = interpolate(graph, points, field)
    np.testing.assert_allclose(values, points @ [0.5, 0.3, 0.2], atol=1e-3)


def test_without_any_value_nothing_is_interpolated(graph):
    nothing = np.full(len(graph.nodes), np.inf)
    assert np.isinf(interpolate(graph, graph.nodes[:2], nothing)).all()
