"""Bones are told from controls, end markers, sockets and roots, by name and by place."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cutcell import Skeleton, SkeletonError, TriangleMesh, deform_joints
from cutcell.rig.deform_joints.body import SPACING, Body
from tests import meshes
from tests.bars import grid_box

BAR = TriangleMesh(*grid_box(20))
CHAIN = [[0.05, 0.1, 0.1], [0.35, 0.1, 0.1], [0.65, 0.1, 0.1]]


def found(joints, parents, names=(), mesh=BAR):
    told = deform_joints(mesh, Skeleton(joints, parents, names))
    return dict(
        zip(names or range(len(joints)), zip(told.deform, told.reason, strict=True), strict=True)
    )


def ruled_out(told):
    return {name: reason for name, (deform, reason) in told.items() if not deform}


def test_joints_in_the_body_are_bones():
    assert ruled_out(found(CHAIN, [-1, 0, 1])) == {}


def test_what_is_called_an_end_is_one_unless_bones_hang_on_it():
    joints = [*CHAIN, [0.8, 0.1, 0.1], [0.9, 0.1, 0.1]]
    told = found(joints, [-1, 0, 1, 2, 3], ["hip", "spine", "neck", "head_end", "head_end_end"])
    assert set(ruled_out(told)) == {"head_end", "head_end_end"}
    told = found(joints, [-1, 0, 1, 2, 3], ["hip", "spine", "low_end", "neck", "head"])
    assert ruled_out(told) == {}


def test_a_last_joint_with_no_skin_beyond_it_marks_an_end():
    assert ruled_out(found([*CHAIN, [0.98, 0.1, 0.1]], [-1, 0, 1, 2])) == {
        3: "end marker: no skin beyond it"
    }


def test_what_is_away_from_the_body_moves_nothing():
    told = found([*CHAIN, [0.5, 0.5, 0.1]], [-1, 0, 1, 1])
    assert ruled_out(told) == {3: "outside of the body"}


def test_a_joint_outside_whose_bone_runs_into_the_body_is_a_bone():
    joints = [[-0.1, 0.1, 0.1], [0.35, 0.1, 0.1], [0.65, 0.1, 0.1]]
    assert ruled_out(found(joints, [-1, 0, 1])) == {}


def test_a_root_on_the_floor_is_no_bone():
    joints = [[0.5, -0.4, 0.1], *CHAIN]
    assert ruled_out(found(joints, [-1, 0, 1, 2])) == {0: "outside of the body"}
    close = [[0.5, -0.03, 0.1], *CHAIN]
    told = found(close, [-1, 0, 1, 2], ["Root", "a", "b", "c"])
    assert ruled_out(told) == {"Root": "root beside the body"}


def test_a_root_is_kept_where_it_moves_all_that_the_others_do_not():
    joints = [[0.5, -0.03, 0.1], [0.2, 0.1, 0.1], [0.8, 0.1, 0.1]]
    assert ruled_out(found(joints, [-1, 0, 0], ["Root", "wheel.L", "wheel.R"])) == {}


def test_a_control_may_be_the_only_joint_that_moves_a_foot():
    joints = [*CHAIN, [0.9, 0.1, 0.1]]
    names = ["hip", "thigh", "shin", "IKFoot"]
    assert ruled_out(found(joints, [-1, 0, 1, -1], names)) == {}
    names = ["hip", "thigh", "foot", "foot.IK"]
    joints[3] = [0.655, 0.1, 0.1]
    told = found(joints, [-1, 0, 1, -1], names)
    assert ruled_out(told) == {"foot.IK": 'control at the place of "foot"'}


@pytest.mark.parametrize(
    "names",
    [
        ["全ての親", "センター", "上半身", "首", "頭", "頭ＩＫ", "頭先"],
        ["全ての親", "ｾﾝﾀｰ", "上半身", "首", "頭", "頭IK", "頭先"],
        ["ParentNode", "Center", "UpperBody", "Neck", "Head", "HeadIK", "HeadTip"],
        ["mother", "center", "upper body", "neck", "head", "head IK", "head tip"],
        ["subete no oya", "sentaa", "jouhanshin", "kubi", "atama", "atama IK", "atama saki"],
    ],
)
def test_controls_of_mmd_are_recognized_in_all_spellings(names):
    joints = [[0.01, 0.01, 0.01], [0.2, 0.1, 0.1], *CHAIN, CHAIN[2], [0.8, 0.1, 0.1]]
    told = found(joints, [-1, 0, 1, 2, 3, 0, 4], names)
    assert set(ruled_out(told)) == {names[0], names[1], names[5], names[6]}


def test_a_centre_elsewhere_is_a_bone():
    told = found(CHAIN, [-1, 0, 1], ["center", "neck", "tail_tip"])
    assert ruled_out(told) == {}


def test_sockets_hold_things_of_their_own():
    told = found([*CHAIN, [0.7, 0.1, 0.1]], [-1, 0, 1, 2], ["a", "b", "hand", "handslot"])
    assert ruled_out(told) == {"handslot": "holds things, by its name"}


def test_place_does_not_count_where_most_joints_are_away_from_the_mesh():
    hat = TriangleMesh(BAR.vertices + np.array([0, 3, 0]), BAR.faces)
    joints = [[0.1, y, 0.1] for y in (1.0, 2.0, 3.1)]
    told = found(joints, [-1, 0, 1], ["hip", "spine_ctrl", "head"], hat)
    assert set(ruled_out(told)) == {"spine_ctrl"}


def test_a_rig_of_nothing_but_controls_is_moved_by_them():
    told = found(CHAIN, [-1, 0, 1], ["a_ctrl", "b_ctrl", "c_ctrl"])
    assert ruled_out(told) == {}


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_units_and_the_order_of_joints_do_not_matter(scale):
    joints = np.array([[0.5, -0.4, 0.1], *CHAIN, [0.98, 0.1, 0.1]])
    parents = np.array([-1, 0, 1, 2, 3])
    expected = np.array([False, True, True, True, False])
    mesh = TriangleMesh(BAR.vertices * scale, BAR.faces)
    assert_array_equal(deform_joints(mesh, Skeleton(joints * scale, parents)).deform, expected)
    order = np.array([3, 0, 4, 2, 1])
    place = np.argsort(order)
    above = np.where(parents >= 0, place[parents], -1)[order]
    told = deform_joints(mesh, Skeleton(joints[order] * scale, above))
    assert_array_equal(told.deform, expected[order])


@pytest.mark.parametrize("name", ["ball", "torus", "tube", "ball_with_holes", "box"])
def test_the_body_knows_inside_from_outside(name):
    mesh = TriangleMesh(*getattr(meshes, name)())
    body = Body(mesh)
    points = body.to_unit(np.random.default_rng(0).uniform(0, 1, (300, 3)))
    clear = points[body.to_surface(points) > 2 * SPACING]
    exact = np.array([body.encloses(p) for p in clear])
    assert (body.inside(clear) == exact).mean() > 0.98


def test_large_triangles_are_sampled_all_over():
    body = Body(TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    inner = np.random.default_rng(1).dirichlet([1, 1, 1], 200)[:, :2]
    points = np.column_stack([inner, np.zeros(200)])
    assert body.to_surface(points).max() < SPACING
    assert_allclose(body._areas.sum(axis=0), [0, 0, 0.5])


def test_without_joints_there_is_nothing_to_tell():
    with pytest.raises(SkeletonError, match="no skeleton"):
        deform_joints(BAR, Skeleton([], []))


def test_where_bones_are_marked_as_deforming_no_others_are():
    names = ["root", "DEF-hip", "rig:DEF-spine", "ORG-neck"]
    told = found([[0.5, -0.4, 0.1], *CHAIN], [-1, 0, 1, 2], names)
    assert set(ruled_out(told)) == {"root", "ORG-neck"}


def test_one_of_two_chains_for_kinematics_at_one_place_moves_skin():
    names = ["hip", "thigh", "shin", "shin_FK"]
    told = found([*CHAIN, CHAIN[2]], [-1, 0, 1, 1], names)
    assert set(ruled_out(told)) == {"shin_FK"}
