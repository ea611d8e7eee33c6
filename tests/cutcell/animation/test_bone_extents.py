"""Bones end where the body and the chain of joints say."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from cutcell import Skeleton, TriangleMesh
from cutcell.animation.bone_extents.fit import fit_bones
from cutcell.animation.bone_extents.probe import BodyProbe
from cutcell.animation.bone_extents.rest_axis import rest_directions
from cutcell.bones.nearest import NodeGrid
from tests import meshes
from tests.bars import grid_box
from tests.paper import bone_distances, build_graph


def limb():
    """Make the graph of a bar from x = 0 to 1, 0.2 thick."""
    return build_graph(TriangleMesh(*grid_box(20)), 32, connectivity="any")


def on_axis(*x):
    return [[value, 0.1, 0.1] for value in x]


def ends(graph, skeleton, joint):
    """List where a joint's bones end, in the file's units."""
    bones, _ = fit_bones(graph, skeleton, NodeGrid.of(graph))
    return graph.lattice.to_file(bones.end[bones.joint == joint])


def test_probe_knows_a_box():
    graph = build_graph(TriangleMesh(*meshes.box(0.0, 1.0)), 32)
    probe = BodyProbe(graph, NodeGrid.of(graph))
    points = np.array([[0.5, 0.5, 0.5], [0.9, 0.5, 0.5], [1.02, 0.5, 0.5], [1.3, 0.5, 0.5]])
    np.testing.assert_array_equal(probe.inside(points), [True, True, False, False])
    np.testing.assert_array_equal(probe.near(points), [True, True, True, False])
    assert probe.inner_part(points[0], points[1]) == 1
    assert 0.5 < probe.inner_part(points[0], [1.4, 0.5, 0.5]) < 0.65
    way = probe.exit_distance(points[[0, 3]], np.array([[1.0, 0, 0]] * 2))
    np.testing.assert_allclose(way, [0.5, 0], atol=1 / 32)
    assert way[1] == 0


def test_a_tip_runs_on_and_is_aimed_at_its_skin():
    graph = limb()
    skeleton = Skeleton(on_axis(0.1, 0.5), [-1, 0])
    np.testing.assert_allclose(ends(graph, skeleton, 0), on_axis(0.5))
    np.testing.assert_allclose(ends(graph, skeleton, 1), on_axis(1.0), atol=1 / 32)
    bones = bone_distances(graph, skeleton, leaf="fit").bones
    aimed = graph.lattice.to_file(bones.end[bones.joint == 1])
    np.testing.assert_allclose(aimed, on_axis(0.77), atol=0.03)


def test_a_fork_without_a_child_along_the_rest_axis_has_a_leaf_bone_besides():
    graph = build_graph(TriangleMesh(*meshes.ball(3)), 32, connectivity="any")
    low, mid, neck, head = ([0.5, 0.5, z] for z in (0.05, 0.1, 0.2, 0.5))
    left, right, up = [0.3, 0.5, 0.55], [0.7, 0.5, 0.55], [0, 0, 1.0]
    joints, parents = [low, mid, neck, head, left, right], [-1, 0, 1, 2, 3, 3]
    ways = [up] * 4 + [[1.0, 0, 0]] * 2
    head_bones = ends(graph, oriented(joints, parents, ways), 3)
    np.testing.assert_allclose(head_bones, [left, right, [0.5, 0.5, 0.95]], atol=1 / 32)
    # With a crown along the axis, or where no axis is known, there are the branches only.
    joints, parents = [*joints, [0.5, 0.5, 0.8]], [*parents, 3]
    assert len(ends(graph, oriented(joints, parents, [*ways, up]), 3)) == 3
    assert len(ends(graph, Skeleton(joints[:6], parents[:6]), 3)) == 2


def test_far_branches_and_those_past_another_child_are_no_bones():
    graph, x = limb(), [1.0, 0, 0]
    joints = on_axis(0.02, 0.06, 0.1, 0.2, 0.6)
    joints[4][1] = 0.12
    parents = [-1, 0, 1, 2, 2]
    assert len(ends(graph, oriented(joints, parents, [x] * 5), 2)) == 1
    assert len(ends(graph, Skeleton(joints, parents), 2)) == 1
    joints[4] = [0.25, 0.19, 0.1]
    assert len(ends(graph, oriented(joints, parents, [x] * 5), 2)) == 2
    # Where no child lies on the axis itself, length does not matter.
    joints[3], joints[4] = [0.2, 0.14, 0.1], [0.5, -0.02, 0.1]
    assert len(ends(graph, oriented(joints, parents, [x] * 5), 2)) == 2


def test_a_foot_hung_on_the_root_continues_the_shin():
    graph = limb()
    root, foot = [0.5, -0.6, 0.1], [0.8, 0.1, 0.1]
    skeleton = Skeleton([root, *on_axis(0.2, 0.5), foot], [-1, 0, 1, 0])
    np.testing.assert_allclose(ends(graph, skeleton, 2), on_axis(0.8))
    assert fit_bones(graph, skeleton, NodeGrid.of(graph))[0].inferred == ((2, 3),)
    # The root itself is outside: it has no bone.
    np.testing.assert_allclose(ends(graph, skeleton, 0), [root])
    # Of two that are about as near neither is right: it ends where they are nearer.
    two = Skeleton([root, *on_axis(0.2, 0.5), [0.8, 0.05, 0.1], [0.8, 0.15, 0.1]], [-1, 0, 1, 0, 0])
    np.testing.assert_allclose(ends(graph, two, 2), on_axis(0.65), atol=1 / 32)


def test_bones_of_a_garment_alone_run_from_joint_to_joint():
    vertices, faces = meshes.ball(3)
    away = vertices - [0.5, 0.5, 0.5]
    plate = np.concatenate([vertices, vertices - 0.05 * away])
    both = np.concatenate([faces, faces[:, ::-1] + len(vertices)])
    graph = build_graph(TriangleMesh(plate, both), 32, connectivity="any")
    joints = [[0.5, 0.5, z] for z in (0.3, 0.5, 0.7, 1.0)]
    skeleton = Skeleton(joints, [-1, 0, 1, 2], deform=[True, True, True, False])
    for joint in range(3):
        np.testing.assert_allclose(ends(graph, skeleton, joint), [joints[joint + 1]])


@pytest.mark.parametrize("parent", [0, 1])
def test_a_twist_joint_at_the_end_of_a_bone_has_its_far_half(parent):
    graph = limb()
    names = ["thigh", "leg", "foot", "leg_twist"]
    skeleton = Skeleton(on_axis(0.1, 0.4, 0.8, 0.8), [-1, 0, 1, parent], names)
    np.testing.assert_allclose(ends(graph, skeleton, 1), on_axis(0.6))
    np.testing.assert_allclose(ends(graph, skeleton, 3), on_axis(0.8))
    bones, _ = fit_bones(graph, skeleton, NodeGrid.of(graph))
    np.testing.assert_allclose(
        graph.lattice.to_file(bones.start[bones.joint == 3]), on_axis(0.6), atol=1e-9
    )
    # Of two joints there the nearer one is the end, whichever comes first.
    for heel, foot in ((0.79, 0.8), (0.8, 0.79)):
        places = on_axis(0.1, 0.4, heel, foot, 0.8)
        two = Skeleton(places, [-1, 0, 1, 1, parent], ["thigh", "leg", "heel", "foot", "leg_twist"])
        np.testing.assert_allclose(ends(graph, two, 4), on_axis(0.8))
    # Another joint there, such as a prop in a hand, leaves the bone as it is.
    other = replace(skeleton, names=[*names[:3], "prop"])
    assert on_axis(0.8)[0] in ends(graph, other, 1).round(9).tolist()


@pytest.mark.parametrize("order", [[0, 1, 2, 3, 4], [3, 1, 4, 0, 2]])
def test_joints_without_a_tree_get_one(order):
    graph = limb()
    joints = np.array(on_axis(0.1, 0.25, 0.4, 0.55, 0.7))
    skeleton = Skeleton(joints[order], [-1] * 5)
    bones, tip = fit_bones(graph, skeleton, NodeGrid.of(graph))
    length = np.linalg.norm(graph.lattice.to_file(bones.end) - joints[order][bones.joint], axis=1)
    assert tip.sum() == 1
    np.testing.assert_allclose(length[~tip], 0.15, atol=1e-9)


def test_two_lone_joints_stay_points():
    graph = limb()
    bones, tip = fit_bones(graph, Skeleton(on_axis(0.2, 0.8), [-1, -1]), NodeGrid.of(graph))
    np.testing.assert_array_equal(bones.start, bones.end)
    assert tip.all()


@pytest.mark.parametrize("name", meshes.ALL)
def test_bones_can_be_fitted_to_anything(name):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 10, connectivity="any")
    joints = [[0.5, 0.5, 0.3], [0.5, 0.5, 0.5], [0.5, 0.52, 0.7], [3, 3, 3], [0.5, 0.5, 0.3]]
    distances = bone_distances(graph, Skeleton(joints, [-1, 0, 1, 0, 0]), leaf="fit")
    assert np.isfinite(distances.bones.end).all()
    assert np.isfinite(distances.joint).any(axis=0).all()


def oriented(joints, parents, along, axis=1):
    """Make a skeleton whose joints' local axis (x, y or z) points along a way, for each."""
    turned = np.array([np.linalg.qr(np.column_stack([way, np.eye(3)]))[0] for way in along])
    for axes, way in zip(turned, along, strict=True):
        axes *= np.sign(axes[:, 0] @ way)
    order = [1, 2, 0] if axis == 2 else [2, 0, 1] if axis == 1 else [0, 1, 2]
    return Skeleton(joints, parents, orientations=turned[:, :, order])


@pytest.mark.parametrize("axis", range(3))
def test_most_only_children_tell_the_rest_axis(axis):
    x = [1.0, 0, 0]
    joints = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [3, 1, 0]]) / 4
    up = [0, 1.0, 0]
    skeleton = oriented(joints, [-1, 0, 1, 2, 3], [x, x, x, up, up], axis)
    np.testing.assert_allclose(rest_directions(skeleton, joints), [x, x, x, up, up], atol=1e-12)
    # Bones that run against the axis tell as much.
    against = replace(skeleton, orientations=-skeleton.orientations)
    np.testing.assert_allclose(rest_directions(against, joints)[0], x, atol=1e-12)


def test_no_rest_axis_without_a_majority_or_where_all_joints_are_alike():
    x, up = [1.0, 0, 0], [0, 1.0, 0]
    joints = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [3, 1, 0]]) / 4
    split = oriented(joints, [-1, 0, 1, 2, 3], [x, up, x, [0, 0, 1.0], up])
    assert rest_directions(split, joints) is None
    few = oriented(joints[:3], [-1, 0, 1], [x, x, x])
    assert rest_directions(few, joints[:3]) is None
    assert rest_directions(Skeleton(joints, [-1, 0, 1, 2, 3]), joints) is None
    alike = oriented(joints, [-1, 0, 1, 2, 3], [x] * 5)
    assert rest_directions(alike, joints) is None


def test_a_last_bone_points_along_the_rest_axis():
    graph, x, up = limb(), [1.0, 0, 0], [0, 0, 1.0]
    parents = [-1, 0, 1, 2, 3]
    joints = on_axis(0.05, 0.1, 0.3, 0.5, 0.7)
    straight = oriented(joints, parents, [up, x, x, x, x])
    np.testing.assert_allclose(ends(graph, straight, 4), on_axis(1.0), atol=1 / 32)
    # Across, there is little room.
    across = oriented(joints, parents, [x, x, x, x, up])
    np.testing.assert_allclose(ends(graph, across, 4), [[0.7, 0.1, 0.2]], atol=1 / 64)
    assert not fit_bones(graph, across, NodeGrid.of(graph))[1].any()
    # It is no more than three times as long as its parent's bone.
    short = oriented(on_axis(0.05, 0.1, 0.2, 0.3, 0.35), parents, [up, x, x, x, x])
    np.testing.assert_allclose(ends(graph, short, 4), on_axis(0.5), atol=1e-9)


def test_an_end_marker_far_off_is_no_end():
    graph = limb()
    for place, end in ((0.6, 0.6), (0.9, 1.0)):
        joints = on_axis(0.1, 0.3, 0.4, place)
        skeleton = Skeleton(joints, [-1, 0, 1, 2], deform=[True, True, True, False])
        np.testing.assert_allclose(ends(graph, skeleton, 2), on_axis(end), atol=1 / 32)


def test_a_last_bone_ends_where_another_is_nearer():
    graph = limb()
    # The last joint points back along the bar at a bone that another chain has there.
    joints = [*on_axis(0.9, 0.8), *on_axis(0.3, 0.25, 0.2)]
    skeleton = Skeleton(joints, [-1, 0, -1, 2, 3])
    np.testing.assert_allclose(ends(graph, skeleton, 1), on_axis(0.55), atol=1 / 32)


LIMB = [[0.5, -0.6, 0.1], *on_axis(0.2, 0.5), [0.75, 0.1, 0.1]]
CONTROL = [False, True, True, True]


def inferred(graph, *arguments, allowed=None, **options):
    """List the joints between which bones are inferred."""
    return fit_bones(graph, Skeleton(*arguments, **options), NodeGrid.of(graph), allowed)[
        0
    ].inferred


def test_bones_are_inferred_only_to_joints_on_controls():
    graph = limb()
    assert inferred(graph, LIMB, [-1, 0, 1, 0], deform=CONTROL) == ((2, 3),)
    # Its parent has a bone that does not lead there: an ear is not continued by a hand.
    hand = [*LIMB, *on_axis(0.9)]
    assert inferred(graph, hand, [-1, 0, 1, 4, 0], deform=[*CONTROL, True]) == ()
    # Farther than the bone before: a toe is not continued by a head.
    far = [*LIMB[:3], *on_axis(0.95)]
    assert inferred(graph, far, [-1, 0, 1, 0], deform=CONTROL) == ()
    # Backward.
    back = [*LIMB[:3], *on_axis(0.35)]
    assert inferred(graph, back, [-1, 0, 1, 0], deform=CONTROL) == ()


def test_no_bone_is_inferred_to_the_end_of_another():
    graph, x = limb(), np.array([0.0, 1.8, 3, 6, 0.75, 1.2, 6]) / 6 * 0.9 + 0.05
    parents = [-1, 0, 1, 2, 0, 0, -1]
    assert inferred(graph, on_axis(*x), parents) == ()


def test_no_bone_is_inferred_between_skins():
    graph = limb()
    options = {"deform": CONTROL}
    allowed = np.zeros((len(graph.vertex_node), 4), bool)
    allowed[:40, :3], allowed[40:, [0, 3]] = True, True
    assert inferred(graph, LIMB, [-1, 0, 1, 0], allowed=allowed, **options) == ()
    allowed[:40, 3] = True
    assert inferred(graph, LIMB, [-1, 0, 1, 0], allowed=allowed, **options) == ((2, 3),)


def test_each_of_two_skeletons_has_the_bones_that_it_has_alone():
    vertices, faces = grid_box(20)
    beside = vertices + np.array([0, 0.3, 0])
    both = TriangleMesh(
        np.concatenate([vertices, beside]), np.concatenate([faces, faces + len(vertices)])
    )
    graph = build_graph(both, 32, connectivity="any")
    joints, parents = np.array(on_axis(0.1, 0.3, 0.5)), np.array([-1, 0, 1])
    one = Skeleton(joints, parents)
    two = Skeleton(np.concatenate([joints, joints + np.array([0, 0.3, 0])]), [-1, 0, 1, -1, 3, 4])
    allowed = np.zeros((len(both.vertices), 6), bool)
    allowed[: len(vertices), :3], allowed[len(vertices) :, 3:] = True, True
    tree = NodeGrid.of(graph)
    bones, aimed = fit_bones(graph, two, tree, allowed)
    alone, aimed_alone = fit_bones(graph, one, tree)
    np.testing.assert_array_equal(bones.end[bones.joint < 3], alone.end)
    np.testing.assert_array_equal(aimed[bones.joint < 3], aimed_alone)


@pytest.mark.parametrize("face", [["eye.L", "eye.R"], ["jaw"], ["Eyes", "Mouth"]])
@pytest.mark.parametrize("is_child", [True, False])
def test_a_head_goes_on_past_its_face(face, is_child):
    graph = build_graph(TriangleMesh(*meshes.ball(3)), 32, connectivity="any")
    spine = [[0.5, 0.5, z] for z in (0.1, 0.2, 0.35)]
    places = [[0.4, 0.3, 0.5], [0.6, 0.3, 0.5]][: len(face)]
    parents = [-1, 0, 1, *[2 if is_child else 1] * len(face)]
    names = ["root", "neck", "head", *face]
    head = ends(graph, Skeleton([*spine, *places], parents, names), 2)
    assert len(head) == 1 + is_child * len(face)
    np.testing.assert_allclose(head[-1], [0.5, 0.5, 0.95], atol=2 / 32)
    # Without such names a joint beside ends it, and children continue it.
    plain = ["root", "neck", "head", "a", "b"][: len(names)]
    assert (ends(graph, Skeleton([*spine, *places], parents, plain), 2)[:, 2] < 0.8).all()


def test_a_long_list_of_joints_without_a_tree_takes_little_memory():
    count = 300
    graph = build_graph(TriangleMesh(*meshes.ball(3)), 16, connectivity="any")
    places = np.random.default_rng(1).uniform(0.3, 0.7, (count, 3))
    grid = NodeGrid.of(graph)
    fit_bones(graph, Skeleton(places[:9], [-1] * 9), grid)
    tracemalloc.start()
    fit_bones(graph, Skeleton(places, [-1] * count), grid)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 20e6  # a float for each of 17 points between any two joints takes 36 MB
