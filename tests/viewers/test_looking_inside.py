"""Slices with their rays, sections, marks, starts: what is drawn is what the core found."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import cutcell
from cutcell.geodesics import trace_path
from cutcell_viewers.character import in_scene, to_scene
from cutcell_viewers.graph_scene import cut_at, depth_field
from cutcell_viewers.interpolation import interpolate
from cutcell_viewers.joint_colors import colors_of, joint_colors
from cutcell_viewers.marks import beads, path_tube, rods, tube, vertex_mark
from cutcell_viewers.palette import EYES, JOINT_COLORS, LIGHT, _srgb_to_oklab, as_seen
from cutcell_viewers.plane_section import plane_section
from cutcell_viewers.ray_slice import slice_rays
from cutcell_viewers.section_scene import (
    body_section,
    field_face,
    section_lines,
    winding_face,
)
from cutcell_viewers.slice_scene import file_axis, slice_place, slice_scene
from cutcell_viewers.start_scene import first_distances, start_scene
from cutcell_viewers.weights_scene import count_colors, difference_colors, dominant_colors


@pytest.fixture(scope="module")
def binding(rig):
    return cutcell.bind(rig, 16, leaf="point")  # fitted bones lie elsewhere


def outward(points, faces, centre):
    corners = points[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return (normal * (corners.mean(axis=1) - centre)).sum(axis=1)


def test_the_scenes_axes_are_found_in_the_files_space(rig):
    assert [file_axis(rig, axis) for axis in "xyz"] == [(0, 1), (2, 1), (1, -1)]


def test_a_slice_lies_where_it_is_asked_for(rig):
    for axis, position, row in (("x", 0.0, 0), ("y", 1.0, 1), ("z", 0.5, 2)):
        normal, index, cut = slice_place(rig, axis, position, 16)
        assert 0 <= index < 16
        points = to_scene(rig, rig.mesh.vertices)
        low, high = points[:, row].min(), points[:, row].max()
        assert cut.origin[row] == pytest.approx(low + position * (high - low), abs=3.0 / 16)
        np.testing.assert_allclose(np.abs(cut.normal), np.eye(3)[row], atol=1e-12)
        assert cut.normal[row] > 0
        assert normal == file_axis(rig, axis)[0]


def test_a_slices_rays_tell_their_winding_number(rig):
    normal, index, cut = slice_place(rig, "z", 0.5, 16)
    result = slice_rays(rig.mesh, 16, axis=0, normal=normal, index=index)
    actors, legend = slice_scene(rig, result, LIGHT)
    rays = actors["slice rays"]
    assert set(rays.reading.values.round(3)) == {0.0, 1.0}
    assert len(rays.reading.values) == len(rays.points)
    for actor in actors.values():
        assert np.isfinite(actor.points).all()
        assert actor.cells.max(initial=-1) < len(actor.points)
        away = (actor.points - np.array(cut.origin)) @ np.array(cut.normal)
        assert np.abs(away).max() < 0.25 * 3.0 / 16
    assert len(actors["slice crossings"].points) == 6 * len(result.crossing)
    inside = actors["slice points"].points.reshape(-1, 6, 3).mean(axis=1)
    body = to_scene(rig, rig.mesh.vertices)
    assert ((inside > body.min(axis=0)) & (inside < body.max(axis=0))).all()
    assert "inding" in legend.title


def test_segments_that_are_decided_otherwise_are_marked(rig):
    normal, index, _ = slice_place(rig, "z", 0.5, 16)
    rays = slice_rays(rig.mesh, 16, axis=0, normal=normal, index=index)
    nowhere = replace(rays, inside=np.zeros_like(rays.inside))
    actors, legend = slice_scene(rig, rays, LIGHT, nowhere)
    assert len(actors["slice differences"].points) == 8 * 2 * rays.inside.sum()
    assert f"{rays.inside.sum()} of" in legend.swatches[-1][1]
    assert "slice differences" not in slice_scene(rig, rays, LIGHT, rays)[0]


def scene_bounds(rig):
    points = to_scene(rig, rig.mesh.vertices)
    return np.stack([points.min(axis=0), points.max(axis=0)])


def test_an_open_section_has_a_contour(rig):
    corners = rig.mesh.vertices[rig.mesh.faces].mean(axis=1)
    hole = np.abs(corners[:, 0] - corners[:, 0].mean()) < 0.15
    hole &= corners[:, 1] == corners[:, 1].max()
    opened = in_scene(rig, cutcell.TriangleMesh(rig.mesh.vertices, rig.mesh.faces[~hole]))
    cut = cut_at(scene_bounds(rig), "y", 0.5)
    section = plane_section(opened, cut.origin, cut.normal, 40)
    lines, swatches = section_lines(section, 0.5, cut, 3.0, LIGHT, contour=True)
    assert set(lines) == {"section outline", "section contour"}
    assert len(swatches) == 2


def test_a_section_shows_the_field(rig, binding):
    graph, field = binding.graph, binding.distances.field(1)
    cut = cut_at(scene_bounds(rig), "z", 0.5)
    result = body_section(rig, graph, cut)
    actor = field_face(rig, graph, result, 0.5, field, (0.0, 1.0), "from b: ")
    assert len(actor.scalars) == len(actor.points)
    assert not actor.clipped
    # Along the beam, beyond the elbow, the field is the distance to the elbow's bone.
    unit = graph.lattice.to_unit([[1.4, 0.0, 0.0], [0.5, 0.0, 0.0]])
    values = interpolate(graph, unit, field) * graph.lattice.size
    np.testing.assert_allclose(values, [0.4, 0.0], atol=0.16)
    image, legend = winding_face(result)
    assert image.cells.max() < len(image.points) == len(image.scalars)
    assert legend.title == "Winding number"


def test_depth_is_zero_on_the_surface_and_grows_inwards(binding):
    graph = binding.graph
    depth = depth_field(graph)
    assert (depth[graph.node_kind != 1] == 0).all()
    middle = np.argmax(depth)
    assert graph.node_kind[middle] == 1
    np.testing.assert_allclose(graph.nodes[middle, 1:], 0.5, atol=1 / 16)


def test_a_mark_is_a_point_over_everything_at_its_vertex(rig):
    mark = vertex_mark(rig, 5)
    np.testing.assert_allclose(mark.points, [to_scene(rig, rig.mesh.vertices[5])], atol=1e-6)
    assert mark.overlay


def test_balls_rods_and_tubes_are_closed_to_the_outside():
    points, faces = beads(np.zeros((1, 3)), 1.0)
    assert (outward(points, faces, np.zeros(3)) > 0).all()
    path = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    points, faces = tube(path, 0.1)
    assert np.linalg.norm(points[:, None] - path, axis=2).min(axis=1).max() <= 1.01
    points, faces, of = rods(path[:2], path[1:], np.array([0.2, 0.1]))
    assert (np.bincount(of) == 8).all()
    assert (outward(points, faces, points.mean(axis=0))[:8] != 0).all()


def test_a_mark_follows_the_weights_of_its_vertex(rig):
    mark = vertex_mark(rig, 5, rig.weights)
    assert (mark.skin.joints[:, 0] == rig.weights[5].argmax()).all()


def test_the_way_back_begins_at_the_vertex(rig, binding):
    way = trace_path(binding.distances, 0, 40).points
    scene = to_scene(rig, binding.graph.lattice.to_file(way))
    actor = path_tube(rig, scene)
    start = to_scene(rig, rig.mesh.vertices[40])
    assert np.linalg.norm(actor.points - start, axis=1).min() < 0.02


def test_distances_begin_at_sources_by_the_bone(rig, binding):
    actors = start_scene(rig, binding.distances, 1, LIGHT)
    first = first_distances(binding.distances, 1)
    assert len(actors["sources"].points) == 6 * len(first)
    assert len(actors["first distances"].points) == 8 * len(first)
    samples = actors["samples"].points.reshape(-1, 6, 3).mean(axis=1)
    elbow, wrist = to_scene(rig, rig.skeleton.joints[1:])
    np.testing.assert_allclose(samples[0], elbow, atol=1e-5)
    np.testing.assert_allclose(samples[-1], wrist, atol=1e-5)
    ends = actors["first distances"].points.reshape(-1, 2, 4, 3).mean(axis=2)
    length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) / binding.graph.lattice.size
    np.testing.assert_allclose(length, first, atol=1e-5)


def test_neighbours_differ_to_every_kind_of_eye():
    parents = np.array([-1, 0, 1, 2, 2, 2, 2, 2, 3, 4, 5, 6, 7, 0, 13, 0, 15, 16])
    colors = joint_colors(parents)
    for eye in EYES:
        seen = _srgb_to_oklab(as_seen(colors, eye))
        for joint, parent in enumerate(parents):
            kin = [k for k in range(joint) if parents[k] == parent or k == parent]
            for other in kin:
                assert np.linalg.norm(seen[joint] - seen[other]) > 0.05, (eye, joint, other)
    assert len(np.unique(joint_colors(np.full(60, -1)), axis=0)) == len(JOINT_COLORS)
    many = joint_colors(np.full(60, -1))
    assert all((a != b).any() for a, b in pairwise(many))


def test_ways_to_colour_weights(rig):
    held = np.array([[0.7, 0.3, 0.0], [0.0, 0.0, 1.0], [0.2, 0.5, 0.3]])
    look, _ = dominant_colors(rig, held)
    assert look["reading"].values.tolist() == [0, 2, 1]
    expected = colors_of(rig)[[0, 2, 1]]
    np.testing.assert_allclose(look["colors"] / 255, expected, atol=0.01)
    look, legend = count_colors(rig, held)
    assert look["scalars"].tolist() == [2, 1, 3]
    assert (legend.low, legend.high) == ("1", "3")
    look, _ = difference_colors(rig, held, np.eye(3))
    np.testing.assert_allclose(look["scalars"], [0.3, 1.0, 0.7], atol=1e-6)
