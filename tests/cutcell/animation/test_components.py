"""Components contain the bones that they should, and accessories follow what they sit on."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from cutcell import Rig, Skeleton, TriangleMesh, bind, build_graph, winding_number
from cutcell.animation.falloff.components import POINTS, bone_containment
from cutcell.animation.falloff.containment import (
    RIGID_AREA,
    cross_component_penalty,
    joint_containment,
    make_rigid,
    ramp,
)
from cutcell.animation.falloff.rigid_accessories import attach, attach_accessories
from cutcell.geodesics import Bones
from cutcell.geometry.triangles import label_components
from cutcell.geometry.welded import WeldedMesh
from tests import meshes
from tests.bars import grid_box


def joined(*parts):
    first = np.cumsum([0, *(len(v) for v, _ in parts)])
    faces = [f + n for (_, f), n in zip(parts, first, strict=False)]
    return np.concatenate([v for v, _ in parts]), np.concatenate(faces)


def test_components_are_what_edges_join():
    vertices, faces = joined(meshes.box(), meshes.ball(1))
    component = label_components(faces, len(vertices) + 1)  # and a vertex that no face uses
    np.testing.assert_array_equal(component, [0] * 8 + [1] * (len(vertices) - 8) + [2])


@pytest.mark.parametrize("name", [*meshes.CLOSED, "tube"])
def test_bones_are_contained_where_the_winding_number_says(name):
    vertices, faces = meshes.ALL[name]()
    rng = np.random.default_rng(0)
    start, end = rng.random((2, 40, 3))
    bones = Bones(start, end, np.arange(40, dtype=np.int32))
    mesh = WeldedMesh.of(vertices, faces)
    mesh.__dict__["component"] = np.zeros(len(vertices), np.int32)  # all are one
    contained = bone_containment(mesh, bones)[0]
    along = (np.arange(POINTS) + 0.5) / POINTS
    points = start[:, None] + along[:, None] * (end - start)[:, None]
    inside = winding_number(TriangleMesh(vertices, faces), points.reshape(-1, 3)) > 0.5
    expected = inside.reshape(40, POINTS).mean(axis=1)
    if name == "tube":  # open: near its mouths six rays cannot know
        assert np.abs(contained - expected).mean() < 0.1
    else:
        np.testing.assert_allclose(contained, expected, atol=1e-9)


def test_points_on_edges_are_counted_once():
    vertices, faces = meshes.box()  # its diagonals meet the axis of the bone
    bones = Bones(np.array([[0.5, 0.5, 0.3]]), np.array([[0.5, 0.5, 0.7]]), np.zeros(1, np.int32))
    contained = bone_containment(WeldedMesh.of(vertices, faces), bones)
    assert contained[0, 0] == pytest.approx(1)


def test_a_bone_in_another_component_counts_as_farther():
    containment = np.array([[1.0, 0.2, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.0]])
    penalty = cross_component_penalty(containment, np.zeros_like(containment, bool))
    np.testing.assert_allclose(penalty[0], [1, 1.75, 1])
    np.testing.assert_allclose(penalty[1], [2, 1, 1])
    np.testing.assert_allclose(penalty[2], 1)  # it contains no bone
    # Other bones in a component do not matter.
    half = np.array([[1.0, 0.5], [0.0, 0.25]])
    np.testing.assert_allclose(
        cross_component_penalty(half, np.zeros_like(half, bool)), [[1, 1], [2, 1.5]]
    )
    np.testing.assert_allclose(cross_component_penalty(containment[:1], np.zeros((1, 3), bool)), 1)


def button(at):
    vertices, faces = meshes.box(-0.04, 0.04)
    return vertices + at, faces


def test_a_button_follows_what_it_sits_on():
    body = grid_box(20)
    vertices, faces = joined(body, button([0.85, 0.1, 0.23]))
    skeleton = Skeleton([[0.1, 0.1, 0.1], [0.5, 0.1, 0.1]], [-1, 0])
    weights = bind(Rig(TriangleMesh(vertices, faces), skeleton), 32).weights
    np.testing.assert_allclose(weights[-8:], [[0, 1]] * 8, atol=1e-12)
    # Across the joint it takes the mean of both, and still moves as one.
    vertices, faces = joined(body, button([0.5, 0.1, 0.23]))
    weights = bind(Rig(TriangleMesh(vertices, faces), skeleton), 32).weights
    np.testing.assert_allclose(weights[-8:], weights[[-1] * 8], atol=1e-12)
    assert 0.3 < weights[-1, 0] < 0.7


def test_what_an_accessory_is_near_counts_beside_what_it_touches():
    vertices, faces = joined(grid_box(20), button([0.5, 0.1, 0.23]))
    graph = build_graph(TriangleMesh(vertices, faces), 16, connectivity="any")
    is_second = (graph.mesh.component == 1) | (graph.mesh.points[:, 0] > 0.5)
    weights = csr_array(np.where(is_second[:, None], [0.0, 1.0], [1.0, 0.0]))
    which = np.array([False, True])
    touching = attach(graph, which, weights).toarray()[graph.mesh.component == 1]
    both = attach(graph, which, weights, weights).toarray()[graph.mesh.component == 1]
    assert (touching[:, 1] < 0.2).all()
    assert (both[:, 1] > 0.4).all()
    np.testing.assert_array_equal(both, both[[0] * 8])


def test_a_rivet_on_a_plate_follows_the_plate():
    vertices, faces = grid_box(20)
    plate = vertices * [0.12, 0.5, 0.1] + [0.47, 0.05, 0.21]
    rivet, few = button([0, 0, 0])
    rivet = rivet * 0.25 + [0.48, 0.1, 0.245]
    vertices, faces = joined(joined((vertices, faces), (plate, faces)), (rivet, few))
    graph = build_graph(TriangleMesh(vertices, faces), 32, connectivity="any")
    of_plate = graph.mesh.component == 1
    weights = csr_array(np.where(of_plate[:, None], [0.0, 1.0], [1.0, 0.0]))
    attached = attach(graph, np.array([False, True, True]), weights, weights).toarray()
    assert (attached[graph.mesh.component == 2, 1] > 0.5).all()


def sheet():
    """Make an open sheet over the bar of `grid_box`."""
    vertices, faces = grid_box(16, 8, 1, size=(0.8, 0.4, 0.26))
    return vertices + np.array([0.1, -0.1, 0]), faces[(vertices[faces][:, :, 2] > 0).all(axis=1)]


def test_a_cape_follows_the_body_under_it():
    body, hand = grid_box(20), grid_box(8, size=(0.3, 0.02, 0.02))
    hand = hand[0] + [0.6, 0.09, 0.33], hand[1]
    vertices, faces = joined(body, hand, sheet())
    joints = [[0.1, 0.1, 0.1], [0.5, 0.1, 0.1], [0.9, 0.1, 0.1], [0.61, 0.1, 0.34]]
    skeleton = Skeleton(joints, [-1, 0, 1, 1], deform=[True, True, False, True])
    weights = bind(Rig(TriangleMesh(vertices, faces), skeleton), 32).weights
    on_sheet = np.isclose(vertices[:, 2], 0.26)
    # The bone of the hand is nearer to it, the surface of the body is, too.
    assert weights[on_sheet, 2:].max() < 0.1
    x = vertices[on_sheet, 0]
    assert weights[on_sheet, 0][x < 0.3].min() > 0.6
    assert weights[on_sheet, 1][x > 0.7].min() > 0.6


def test_a_body_in_patches_has_no_accessories():
    vertices, faces = grid_box(4)
    soup = vertices[faces].reshape(-1, 3) + np.repeat(np.arange(len(faces)) * 1e-3, 3)[:, None]
    triangles = np.arange(len(soup)).reshape(-1, 3)
    graph = build_graph(TriangleMesh(soup, triangles), 16, connectivity="any")
    surface = graph.mesh
    containment = np.zeros((len(surface.longest_sides), 2))
    containment[0, 0] = 1
    weights = csr_array(np.random.default_rng(0).random((len(surface.points), 2)))
    independent = np.zeros(len(containment), bool)
    assert attach_accessories(graph, containment, weights, weights, independent) is weights


def test_a_lone_component_has_no_penalty():
    penalty = cross_component_penalty(np.array([[0.2, 0.0, 1.0]]), np.zeros((1, 3), bool))
    np.testing.assert_array_equal(penalty, 1.0)


def test_a_component_follows_the_joint_that_nearly_all_of_it_follows():
    one, two = grid_box(8), grid_box(8)
    vertices, faces = joined(one, (two[0] + [0, 1, 0], two[1]))
    surface = WeldedMesh.of(vertices, faces.astype(np.int32))
    weights = np.tile([0.6, 0.4], (len(vertices), 1))
    weights[5] = 0.4, 0.6
    followed = make_rigid(surface, csr_array(weights), np.array([False, True])).toarray()
    np.testing.assert_array_equal(followed[: len(one[0])], [[1, 0]] * len(one[0]))
    np.testing.assert_array_equal(followed[len(one[0]) :], weights[len(one[0]) :])
    # Up to where it is rigid, nothing jumps.
    assert ramp(
        np.array([0.5, RIGID_AREA[0], np.mean(RIGID_AREA), RIGID_AREA[1]]), *RIGID_AREA
    ) == pytest.approx([0, 0, 0.5, 1])
    split = csr_array(np.where(vertices[:, :1] < 0.7, [0.6, 0.4], [0.4, 0.6]))
    assert make_rigid(surface, split, np.zeros(2, bool)) is split


def test_an_armoured_limb_is_rigid():
    lower, upper = grid_box(8), grid_box(8)
    vertices, faces = joined((lower[0] * [0.5, 1, 1], lower[1]), (upper[0] * [0.5, 1, 1], upper[1]))
    vertices[len(lower[0]) :, 0] += 0.51  # they touch nowhere, else they would be one component
    skeleton = Skeleton([[0.02, 0.1, 0.1], [0.52, 0.1, 0.1]], [-1, 0])
    weights = bind(Rig(TriangleMesh(vertices, faces), skeleton), 32).weights
    np.testing.assert_array_equal(weights[: len(lower[0]), 0], 1)
    np.testing.assert_array_equal(weights[len(lower[0]) :, 1], 1)


def test_what_has_no_area_is_no_accessory():
    vertices, faces = grid_box(8)
    far = np.array([[1, 0, 0], [2, 0, 0], [3, 0, 0]])
    lines = (
        np.vstack([vertices, far * 1e5, -far * 1e5]),
        np.vstack([faces, np.arange(6).reshape(2, 3) + len(vertices)]),
    )
    stray = np.vstack([vertices, [[1e20, 0, 0]]]), faces
    skeleton = Skeleton([[0.1, 0.1, 0.1], [0.5, 0.1, 0.1]], [-1, 0])
    for mesh in (lines, stray):
        weights = bind(Rig(TriangleMesh(*mesh), skeleton), 16).weights
        np.testing.assert_allclose(weights.sum(axis=1), 1)


def head_with_eyes():
    """Make a ball with two small balls in its surface, and a joint in each."""
    places = [[0.4, 0.12, 0.55], [0.6, 0.12, 0.55]]
    small = [(0.08 * (meshes.ball(1)[0] - 0.5) / 0.45 + at, meshes.ball(1)[1]) for at in places]
    mesh = TriangleMesh(*joined(meshes.ball(3), *small))
    joints = [[0.5, 0.5, 0.1], [0.5, 0.5, 0.4], *places]
    return Rig(mesh, Skeleton(joints, [-1, 0, 1, 1], ["neck", "top", "a", "b"]))


def test_a_joint_in_a_small_component_of_its_own_keeps_to_it():
    rig = head_with_eyes()
    count = len(meshes.ball(3)[0])
    weights = bind(rig, 24).weights
    assert weights[:count, 2:].max() == 0
    each = np.arange(count, len(weights)) >= count + len(meshes.ball(1)[0])
    np.testing.assert_allclose(weights[count:][~each, 2], 1, atol=1e-6)
    np.testing.assert_allclose(weights[count:][each, 3], 1, atol=1e-6)


def test_no_component_is_of_two_joints():
    rig = head_with_eyes()
    joints = np.concatenate([rig.skeleton.joints, rig.skeleton.joints[2:3] + 0.01])
    graph = build_graph(rig.mesh, 16)
    surface = graph.mesh
    skeleton = Skeleton(joints, [-1, 0, 1, 1, 1])
    place = graph.lattice.to_unit(joints)
    bones = Bones(place, place, np.arange(5, dtype=np.int32))
    owned = joint_containment(surface, bones, skeleton, 5)[1]
    np.testing.assert_array_equal(owned.any(axis=0), [False, False, False, True, False])
