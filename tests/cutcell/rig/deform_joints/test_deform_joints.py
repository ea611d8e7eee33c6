"""Bones are told from controls, end markers, sockets and roots, by name and by place."""

import tracemalloc

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cutcell import Skeleton, SkeletonError, TriangleMesh, deform_joints
from cutcell.rig.deform_joints import body
from cutcell.rig.deform_joints.body import SURFACE_SPACING, Body
from tests import meshes
from tests.bars import grid_box

BAR = TriangleMesh(*grid_box(20))
CHAIN = [[0.05, 0.1, 0.1], [0.35, 0.1, 0.1], [0.65, 0.1, 0.1]]


def found(joints, parents, names=(), mesh=BAR):
    reports = deform_joints(mesh, Skeleton(joints, parents, names))
    return dict(
        zip(
            names or range(len(joints)),
            zip(reports.deform, reports.reason, strict=True),
            strict=True,
        )
    )


def ruled_out(told):
    return {name: reason for name, (deform, reason) in told.items() if not deform}


def test_joints_in_the_body_are_bones():
    assert ruled_out(found(CHAIN, [-1, 0, 1])) == {}


def test_what_is_called_an_end_is_one_unless_bones_hang_on_it():
    joints = [*CHAIN, [0.8, 0.1, 0.1], [0.9, 0.1, 0.1]]
    reports = found(joints, [-1, 0, 1, 2, 3], ["hip", "spine", "neck", "head_end", "head_end_end"])
    assert set(ruled_out(reports)) == {"head_end", "head_end_end"}
    reports = found(joints, [-1, 0, 1, 2, 3], ["hip", "spine", "low_end", "neck", "head"])
    assert ruled_out(reports) == {}


def test_a_last_joint_with_no_skin_beyond_it_marks_an_end():
    assert ruled_out(found([*CHAIN, [1.01, 0.1, 0.1]], [-1, 0, 1, 2])) == {
        3: "end marker: no skin beyond it"
    }
    assert ruled_out(found([*CHAIN, [0.99, 0.1, 0.1]], [-1, 0, 1, 2])) == {}


def test_what_is_away_from_the_body_moves_nothing():
    reports = found([*CHAIN, [0.5, 0.5, 0.1]], [-1, 0, 1, 1])
    assert ruled_out(reports) == {3: "outside of the body"}


def test_a_joint_outside_whose_bone_runs_into_the_body_is_a_bone():
    joints = [[-0.06, 0.1, 0.1], [0.35, 0.1, 0.1], [0.65, 0.1, 0.1]]
    assert ruled_out(found(joints, [-1, 0, 1])) == {}


def test_a_root_on_the_floor_is_no_bone():
    joints = [[0.5, -0.4, 0.1], *CHAIN]
    assert ruled_out(found(joints, [-1, 0, 1, 2])) == {0: "root beside the body"}
    close = [[0.5, -0.03, 0.1], *CHAIN]
    reports = found(close, [-1, 0, 1, 2], ["Root", "a", "b", "c"])
    assert ruled_out(reports) == {"Root": "root beside the body"}


def test_a_root_is_kept_where_it_moves_all_that_the_others_do_not():
    joints = [[0.5, -0.03, 0.1], [0.2, 0.1, 0.1], [0.8, 0.1, 0.1]]
    assert ruled_out(found(joints, [-1, 0, 0], ["Root", "wheel.L", "wheel.R"])) == {}


def test_a_control_without_bones_below_it_moves_a_foot_only_if_nothing_else_is_near():
    joints = [*CHAIN, [0.9, 0.1, 0.1]]
    names = ["hip", "thigh", "shin", "IKFoot"]
    assert set(ruled_out(found(joints, [-1, 0, 1, -1], names))) == {"IKFoot"}
    reports = deform_joints(BAR, Skeleton([*CHAIN[:2], joints[3]], [-1, 0, -1], [*names[:2], "IK"]))
    assert reports.deform.all()
    assert reports.doubtful.tolist() == [False, False, True]
    names = ["hip", "thigh", "foot", "foot.IK"]
    joints[3] = [0.655, 0.1, 0.1]
    reports = found(joints, [-1, 0, 1, -1], names)
    assert ruled_out(reports) == {"foot.IK": 'control at the place of "foot"'}


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
    reports = found(joints, [-1, 0, 1, 2, 3, 0, 4], names)
    assert set(ruled_out(reports)) == {names[0], names[1], names[5], names[6]}


def test_a_centre_elsewhere_is_a_bone():
    reports = found(CHAIN, [-1, 0, 1], ["center", "neck", "tail_tip"])
    assert ruled_out(reports) == {}


def test_sockets_hold_things_of_their_own():
    reports = found([*CHAIN, [0.7, 0.1, 0.1]], [-1, 0, 1, 2], ["a", "b", "hand", "handslot"])
    assert ruled_out(reports) == {"handslot": "holds things, by its name"}


def test_place_does_not_count_where_most_joints_are_away_from_the_mesh():
    hat = TriangleMesh(BAR.vertices + np.array([0, 3, 0]), BAR.faces)
    joints = [[0.1, y, 0.1] for y in (1.0, 2.0, 3.1)]
    reports = found(joints, [-1, 0, 1], ["hip", "spine_ctrl", "head"], hat)
    assert set(ruled_out(reports)) == {"spine_ctrl"}


def test_a_rig_of_nothing_but_controls_is_moved_by_them():
    reports = found(CHAIN, [-1, 0, 1], ["a_ctrl", "b_ctrl", "c_ctrl"])
    assert ruled_out(reports) == {}


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_units_and_the_order_of_joints_do_not_matter(scale):
    joints = np.array([[0.5, -0.4, 0.1], *CHAIN, [1.01, 0.1, 0.1]])
    parents = np.array([-1, 0, 1, 2, 3])
    expected = np.array([False, True, True, True, False])
    mesh = TriangleMesh(BAR.vertices * scale, BAR.faces)
    assert_array_equal(deform_joints(mesh, Skeleton(joints * scale, parents)).deform, expected)
    order = np.array([3, 0, 4, 2, 1])
    place = np.argsort(order)
    above = np.where(parents >= 0, place[parents], -1)[order]
    reports = deform_joints(mesh, Skeleton(joints[order] * scale, above))
    assert_array_equal(reports.deform, expected[order])


@pytest.mark.parametrize("name", ["ball", "torus", "tube", "ball_with_holes", "box"])
def test_the_body_knows_inside_from_outside(name):
    mesh = TriangleMesh(*getattr(meshes, name)())
    body = Body(mesh)
    points = body.to_unit(np.random.default_rng(0).uniform(0, 1, (300, 3)))
    clear = points[body.to_surface(points) > 2 * SURFACE_SPACING]
    exact = np.array([body.encloses(p) for p in clear])
    assert (body.inside(clear) == exact).mean() > 0.98


def test_large_triangles_are_sampled_all_over():
    body = Body(TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    inner = np.random.default_rng(1).dirichlet([1, 1, 1], 200)[:, :2]
    points = np.column_stack([inner, np.zeros(200)])
    assert body.to_surface(points).max() < SURFACE_SPACING
    assert_allclose(body.areas.sum(axis=0), [0, 0, 0.5])


def test_without_joints_there_is_nothing_to_tell():
    with pytest.raises(SkeletonError, match="no skeleton"):
        deform_joints(BAR, Skeleton([], []))


def test_where_bones_are_marked_as_deforming_no_others_are():
    names = ["root", "DEF-hip", "rig:DEF-spine", "DEF-neck", "ORG-head", "hat", "torso"]
    joints = [[0.5, -0.4, 0.1], *CHAIN, CHAIN[2], CHAIN[2], CHAIN[0]]
    reports = found(joints, [-1, 0, 1, 2, 3, 3, 0], names)
    assert set(ruled_out(reports)) == {"root", "ORG-head", "torso"}


def test_one_of_two_chains_for_kinematics_at_one_place_moves_skin():
    names = ["hip", "thigh", "shin", "shin_FK"]
    reports = found([*CHAIN, CHAIN[2]], [-1, 0, 1, 1], names)
    assert set(ruled_out(reports)) == {"shin_FK"}


def test_parts_that_are_inside_out_keep_their_joints():
    """As two hands in one place, one mirrored by a negative scale."""
    other = TriangleMesh(BAR.vertices * [1, -1, 1] + [0, 0.205, 0], BAR.faces)
    faces = [BAR.faces, other.faces + len(BAR.vertices)]
    both = TriangleMesh(np.concatenate([BAR.vertices, other.vertices]), np.concatenate(faces))
    assert Body(both).inside(Body(both).to_unit(np.array(CHAIN))).all()
    assert ruled_out(found(CHAIN, [-1, 0, 1], mesh=both)) == {}


def test_joints_that_were_never_placed_are_no_bones():
    joints = [[0.5, -0.02, 0.1], *CHAIN, [0.5, -0.02, 0.1], [0.8, 0.1, 0.1], [0.5, -0.02, 0.1]]
    reports = found(joints, [-1, 0, 1, 2, 3, 4, 0], ["root", "a", "b", "c", "d", "e", "f"])
    unplaced = 'not placed: at "root"'
    assert ruled_out(reports) == {"root": "root beside the body", "d": unplaced, "f": unplaced}


def test_a_joint_at_the_place_of_its_children_stays_unless_named_root():
    joints = [CHAIN[0], *CHAIN]
    for name, deform in (("Hips", True), ("Root", False)):
        reports = deform_joints(BAR, Skeleton(joints, [-1, 0, 1, 2], [name, "a", "b", "c"]))
        assert reports.deform.tolist() == [deform, True, True, True]
        assert reports.doubtful.tolist() == [deform, False, False, False]
        assert reports.reason[0] == 'root at the place of "a"'


def test_of_two_chains_the_one_that_goes_further_moves_the_skin():
    joints = [*CHAIN, [0.9, 0.1, 0.1], *CHAIN]
    reports = found(joints, [-1, 0, 1, 2, 0, 4, 5], [f"Bone.{k}" for k in range(7)])
    assert set(ruled_out(reports)) == {"Bone.5", "Bone.6"}
    # Alone at the end of a limb, at the place of the foot: what moves it by inverse kinematics.
    joints = [*CHAIN, [0.9, 0.1, 0.1], [0.9, 0.1, 0.1]]
    reports = found(joints, [-1, 0, 1, 2, -1], [f"Bone.{k}" for k in range(5)])
    assert ruled_out(reports) == {"Bone.4": 'at the place of "Bone.3"'}


def test_partners_and_siblings_at_one_place_are_no_doubles():
    joints = [*CHAIN, CHAIN[1], CHAIN[1]]
    assert ruled_out(found(joints, [-1, 0, 1, 0, 2], ["hip", "a", "b", "wing.L", "wing.R"])) == {}


@pytest.mark.parametrize("legs", [2, 3])
def test_a_root_in_the_body_is_doubtful(legs):
    joints, parents = [[0.3, 0.1, 0.1]], [-1]
    for k in range(legs):
        joints += [[0.4, 0.05 + 0.05 * k, 0.1], [0.8, 0.05 + 0.05 * k, 0.1]]
        parents += [0, len(joints) - 2]
    reports = deform_joints(
        BAR, Skeleton(joints, parents, ["root", *(f"leg{k}" for k in range(2 * legs))])
    )
    assert reports.deform.all()
    assert reports.doubtful.tolist() == [True] + [False] * 2 * legs


def test_a_root_in_the_middle_of_a_fish_is_a_bone():
    joints = [[0.5, 0.1, 0.1], [0.3, 0.1, 0.1], [0.1, 0.1, 0.1], [0.7, 0.1, 0.1]]
    reports = deform_joints(BAR, Skeleton(joints, [-1, 0, 1, 0], ["root", "tail", "fin", "head"]))
    assert reports.deform.all()
    assert reports.doubtful.tolist() == [True, False, False, False]


def test_a_long_way_from_a_root_outside_is_no_bone():
    joints = [[-0.12, -0.03, 0.1], [0.5, 0.1, 0.1], [0.6, 0.1, 0.1], [0.7, 0.1, 0.1]]
    assert ruled_out(found(joints, [-1, 0, 1, 2])) == {0: "root beside the body"}


def test_a_limb_that_the_mesh_has_not_is_doubtful():
    joints = [*CHAIN, [0.5, 0.1, 0.2], [0.5, 0.3, 0.2], [0.5, 0.6, 0.2]]
    reports = deform_joints(BAR, Skeleton(joints, [-1, 0, 1, 1, 3, 4]))
    assert reports.deform.tolist() == [True] * 4 + [False] * 2
    assert reports.doubtful.tolist() == [False] * 3 + [True] + [False] * 2


def test_a_control_of_a_foot_that_has_bones_is_none():
    joints = [*CHAIN, [0.75, 0.1, 0.1], [0.8, 0.12, 0.1]]
    names = ["hip", "thigh", "shin", "foot.L", "FootIK.L"]
    reports = found(joints, [-1, 0, 1, 2, -1], names)
    assert ruled_out(reports) == {"FootIK.L": 'control of "foot.L"'}


def test_a_root_in_the_body_that_moves_controls_is_none():
    joints = [CHAIN[1], CHAIN[0], CHAIN[2], CHAIN[2]]
    names = ["root", "spine", "head", "hand_ctrl"]
    reports = found(joints, [-1, 0, 1, 0], names)
    assert set(ruled_out(reports)) == {"root", "hand_ctrl"}


def test_a_twist_yields_to_what_is_at_its_place():
    joints = [*CHAIN, CHAIN[2], [0.9, 0.1, 0.1]]
    names = ["hip", "neck", "neck_twist", "head", "head_top"]
    reports = deform_joints(BAR, Skeleton(joints, [-1, 0, 1, 0, 3], names))
    assert reports.deform.tolist() == [True, True, False, True, True]


def test_of_two_bones_of_a_tool_at_one_place_none_is_ruled_out():
    names = ["root.x", "spine_01.x", "thigh_stretch.l", "c_traj", "head.x"]
    joints = [*CHAIN[:2], CHAIN[2], [0.5, -0.5, 0.1], CHAIN[1]]
    reports = deform_joints(BAR, Skeleton(joints, [-1, 0, 1, -1, -1], names))
    assert reports.deform.tolist() == [True, True, True, False, True]
    assert reports.doubtful.tolist() == [False, True, False, False, True]


def test_a_joint_that_was_ruled_out_is_doubted_where_the_skin_has_no_other():
    joints = [*CHAIN[1:], [0.03, 0.1, 0.1], [0.95, 0.1, 0.1]]
    names = ["spine", "head", "target", "head_end"]
    reports = deform_joints(BAR, Skeleton(joints, [-1, 0, 0, 1], names))
    assert reports.deform.tolist() == [True, True, True, False]
    assert reports.doubtful.tolist() == [False, False, True, False]


def test_mirror_axes_and_the_order_of_joints_and_vertices_do_not_matter():
    names = ["Root", "hip", "thigh.L", "foot.L", "FootIK.L", "foot.L.001", "hat", "hat_end", "far"]
    joints = [[0.5, -0.4, 0.1], *CHAIN, [0.7, 0.12, 0.1], CHAIN[2], [0.2, 0.15, 0.1]]
    joints = np.array([*joints, [0.25, 0.15, 0.1], [0.5, 0.5, 0.1]])
    parents = np.array([-1, 0, 1, 2, 0, 0, 1, 6, 1])
    plain = deform_joints(BAR, Skeleton(joints, parents, names))
    assert plain.deform.tolist() == [False] + [True] * 3 + [False] * 2 + [True] + [False] * 2
    for seed in range(5):
        random = np.random.default_rng(seed)
        order, points = random.permutation(9), random.permutation(len(BAR.vertices))
        place = np.argsort(points)
        faces = random.permutation(place[BAR.faces][:, [0, 2, 1]])
        turn = np.diag([-3.0, 3.0, 3.0]) @ np.roll(np.eye(3), seed, axis=1)
        mesh = TriangleMesh(BAR.vertices[points] @ turn, faces)
        above = np.where(parents >= 0, np.argsort(order)[parents], -1)[order]
        swapped = [names[j].replace(".L", ".R") for j in order]
        reports = deform_joints(mesh, Skeleton(joints[order] @ turn, above, swapped))
        assert_array_equal(reports.deform, plain.deform[order])
        assert_array_equal(reports.doubtful, plain.doubtful[order])


def test_samples_in_blocks_are_those_of_the_whole(monkeypatch):
    mesh = TriangleMesh(*meshes.torus())
    whole = Body(mesh)
    monkeypatch.setattr(body, "PAIRS_TOGETHER", 4000)
    blocks = Body(mesh)
    assert_allclose(blocks.points, whole.points, atol=1e-12)
    points = np.random.default_rng(0).random((50, 3))
    assert_allclose(blocks.away(points), whole.away(points), atol=1e-12)


def test_large_triangles_in_one_place_take_bounded_memory(monkeypatch):
    """A file of a few bytes may draw its mesh any number of times."""
    monkeypatch.setattr(body, "MAX_SURFACE_SAMPLES", 1_000_000)
    corners = np.random.default_rng(0).random((6000, 3))
    mesh = TriangleMesh(corners, np.arange(6000).reshape(-1, 3))
    tracemalloc.start()
    try:
        whole = Body(mesh)
        assert tracemalloc.get_traced_memory()[1] < 250e6
    finally:
        tracemalloc.stop()
    assert len(whole.points) > 100_000
    assert whole.to_surface(np.full((1, 3), 0.5)) < SURFACE_SPACING
