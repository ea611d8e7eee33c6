"""Walls of voids and reverse sides of faces are left out of the graph."""

import numpy as np
import pytest

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh, build_graph
from cutcell.graph.surface import REVERSE, WALL
from tests import meshes
from tests.bars import bar, grid_box
from tests.cutcell.geometry.test_closed_parts import at, joined


def turned(part):
    return part[0], part[1][:, ::-1]


def scaled(part, scale):
    return (part[0] - 0.5) * scale + 0.5, part[1]


def graph_of(mesh, **options):
    return build_graph(TriangleMesh(*mesh), 16, **options)


def hollow(wall=0.01, share=1.0):
    """Make a ball with a second surface inside, which lacks some faces."""
    ball = meshes.ball(3)
    inside = turned(scaled(ball, 1 - wall / 0.45))
    chosen = np.random.default_rng(0).random(len(inside[1])) < share
    return joined(ball, (inside[0], inside[1][chosen]))


@pytest.mark.parametrize("connectivity", [26, "any"])
@pytest.mark.parametrize("wall", [0.002, 0.01, 0.05, 0.2])
def test_a_hollow_body_is_full(wall, connectivity):
    solid = graph_of(meshes.ball(3), connectivity=connectivity)
    graph = graph_of(hollow(wall), connectivity=connectivity)
    np.testing.assert_array_equal(graph.nodes, solid.nodes)
    np.testing.assert_array_equal(graph.edges, solid.edges)
    np.testing.assert_array_equal(graph.omitted, np.repeat([0, WALL], 1280))
    outer, inner = graph.vertex_node.reshape(2, -1)
    np.testing.assert_array_equal(inner, outer)


def test_the_paper_leaves_voids_empty():
    graph = graph_of(hollow(), connectivity=6)
    assert not graph.omitted.any()
    assert len(graph.interior) < len(graph_of(meshes.ball(3)).interior) / 2
    assert not graph_of(hollow(), orient=False).omitted.any()


def test_the_wall_of_a_void_may_have_holes():
    graph = graph_of(hollow(share=0.97))
    assert len(graph.interior) == len(graph_of(meshes.ball(3)).interior)
    assert (graph.omitted[1280:] == WALL).all()


def cut(part, top):
    vertices, faces = part
    return vertices, faces[vertices[faces][:, :, 2].max(axis=1) < top]


def test_what_is_no_hollow_body_stays():
    ball = meshes.ball(3)
    eyeball, mouth = joined(ball, scaled(ball, 0.9)), joined(ball, turned(scaled(ball, 0.4)))
    outline = joined(ball, turned(scaled(ball, 1.02)))
    sleeve = joined(cut(ball, 0.7), cut(turned(scaled(ball, 0.95)), 0.7))
    for mesh in (eyeball, mouth, outline, sleeve):
        assert not graph_of(mesh).omitted.any()


def test_weights_of_a_hollow_limb_are_those_of_the_solid_one():
    rig = bar()
    inner, faces = grid_box(20, size=(0.98, 0.18, 0.18))
    mesh = joined((rig.mesh.vertices, rig.mesh.faces), turned(at((inner, faces), 0.01, 0.01, 0.01)))
    solid = cutcell.bind(rig, 16).weights
    weights = cutcell.bind(Rig(TriangleMesh(*mesh), rig.skeleton), 16).weights
    np.testing.assert_allclose(weights[: len(solid)], solid, atol=1e-12)
    np.testing.assert_allclose(weights[len(solid) :], solid, atol=0.1)


def test_the_check_names_a_hollow_body_and_repairs_it():
    vertices, faces = hollow()
    skeleton = Skeleton([[0.5, 0.5, 0.5]], [-1])
    rig = Rig(TriangleMesh(vertices, faces), skeleton, np.ones((len(vertices), 1)))
    diagnosis = cutcell.diagnose(rig, 16)
    finding = diagnosis["hollow-body"]
    assert finding.faces.tolist() == list(range(1280, 2560))
    assert not {"unused-vertices", "degenerate-faces", "duplicate-faces"} & {
        one.code for one in diagnosis.findings
    }
    assert len(diagnosis.repaired(["hollow-body"]).rig.mesh.faces) == 1280


REPEATS = {
    "all, by the same vertices": lambda v, f: (v, np.concatenate([f, f[:, ::-1]])),
    "all, by others": lambda v, f: joined((v, f), (v, f[:, ::-1])),
    "the reverse first": lambda v, f: (v, np.concatenate([f[:, ::-1], f])),
    "some": lambda v, f: (v, np.concatenate([f, f[::7, ::-1]])),
    "a half": lambda v, f: (v, np.concatenate([f, cut((v, f), 0.5)[1][:, ::-1]])),
}


@pytest.mark.parametrize("connectivity", [6, "any"])
@pytest.mark.parametrize("repeat", REPEATS)
@pytest.mark.parametrize("name", ["ball", "open"])
def test_faces_and_their_reverse_count_once(name, repeat, connectivity):
    body = meshes.ball(2) if name == "ball" else cut(meshes.ball(2), 0.8)
    expected = graph_of(body, connectivity=connectivity)
    graph = graph_of(REPEATS[repeat](*body), connectivity=connectivity)
    assert set(np.unique(graph.omitted)) == {0, REVERSE}
    np.testing.assert_array_equal(graph.nodes, expected.nodes)
    edges, once = (np.unique(one.edges, axis=0) for one in (graph, expected))
    np.testing.assert_array_equal(edges, once)


def test_sheets_and_walls_between_bodies_keep_both_sides():
    flat = grid_box(4, 4, 1, (1, 1, 0.1))
    sheet = flat[0], flat[1][(flat[0][flat[1]][:, :, 2] == 0).all(axis=1)]
    both = joined(sheet, turned(sheet))
    assert not graph_of(both).omitted.any()
    assert not graph_of(joined(meshes.ball(2), both)).omitted.any()
    assert not graph_of(meshes.two_boxes_that_touch()).omitted.any()
