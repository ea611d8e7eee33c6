"""Saved poses: part of the edits, measured by the edge that stretches most, filmed in turn."""

from dataclasses import replace

import numpy as np
import panel_material_ui as pmui
import pytest
from panel.util import edit_readonly

from cutcell import Edits, SavedPose
from cutcell.pose import linear_blend_skinning, pose_at, rotate_joint
from cutcell.rig import Clip
from cutcell_app.document import loading
from cutcell_app.editing.correct import commands as correct
from cutcell_app.features.pose import pose_list, poses
from cutcell_app.features.pose.controls import CONTROLS
from cutcell_app.features.pose.stretches import SHORTEST, worst_edges
from cutcell_app.looks.pose import POSES, chosen_clip, saved_pose, turned
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import draw
from cutcell_app.widgets.rows import Rows
from cutcell_viewers.pose_scene import through_poses
from tests.app.small import small_rig
from tests.viewers.arm import arm_rig

BENT = {1: (0.0, 40.0, 10.0)}
POSE = SavedPose({"elbow": BENT[1]})


@pytest.fixture
def posed(bound, loop):
    """Show the arm on the panel Pose, bent."""
    bound.state.param.update(panel="pose", turns=BENT)
    loop.rest(bound)
    return bound


def slow_worst(rig, weights, transforms):
    """Return the largest stretch of all edges of faces, one by one."""
    points = rig.mesh.vertices
    moved = linear_blend_skinning(points, weights, transforms)
    least = SHORTEST * np.ptp(points, axis=0).max()
    return max(
        np.linalg.norm(moved[a] - moved[b]) / max(np.linalg.norm(points[a] - points[b]), least)
        for face in rig.mesh.faces
        for a, b in zip(face, np.roll(face, 1), strict=True)
    )


def test_the_worst_edge_is_that_of_all_edges():
    rig = arm_rig()
    saved = {"bent": POSE, "rest": SavedPose(), "half": SavedPose(clip="wave", seconds=0.5)}
    result = worst_edges(rig, rig.weights, "linear", saved)
    for name, pose in saved.items():
        expected = slow_worst(rig, rig.weights, saved_pose(rig, pose))
        assert result[name].factor == pytest.approx(expected, rel=1e-5), name
    assert result["rest"].factor == pytest.approx(1)
    # The arm follows the elbow and the wrist from x = 0 on: the edges that tear end there.
    assert abs(rig.mesh.vertices[result["bent"].vertex, 0]) <= 0.3
    clips = worst_edges(rig, rig.weights, "linear", None)
    frames = [slow_worst(rig, rig.weights, one) for one in rig.clips[0].transforms]
    assert clips[0].factor == pytest.approx(max(frames), rel=1e-5)
    assert clips[0].seconds == 1
    assert worst_edges(rig, 0 * rig.weights, "linear", saved) == {}
    smooth = worst_edges(rig, rig.weights, "dual", {"bent": POSE})["bent"].factor
    assert smooth == pytest.approx(result["bent"].factor, rel=1e-5)  # one joint for each vertex


def test_a_pose_is_saved_shown_renamed_and_deleted_with_the_edits(posed, loop):
    state = posed.state
    binding = state.binding
    poses.save(posed, " bent ")
    loop.rest(posed)
    assert state.edits.poses == {"bent": POSE}
    assert Edits.from_json(state.edits.to_json()) == state.edits
    assert state.binding is binding, "poses change no weights, which are not computed again"
    state.turns = {0: (0.0, 0.0, 30.0)}
    assert poses.shown_key(state) is None
    poses.save(posed, "raised")
    assert poses.shown_key(state) == "raised"
    poses.show(posed, "bent")
    assert state.turns == BENT
    poses.rename(posed, "raised")
    assert 'nother pose is called "raised"' in state.message[1]
    poses.rename(posed, "elbow")
    assert list(state.edits.poses) == ["elbow", "raised"]
    assert poses.shown_key(state) == "elbow"
    poses.delete(posed)
    assert list(state.edits.poses) == ["raised"]
    for expected in (["elbow", "raised"], ["bent", "raised"]):
        keys.act(posed, "undo")
        assert list(state.edits.poses) == expected
    keys.act(posed, "redo")
    assert list(state.edits.poses) == ["elbow", "raised"]


def test_a_new_name_leaves_the_pose_of_the_old_one(posed):
    state = posed.state
    field = draw(posed, pose_list.SAVED).select(pmui.TextInput)[0]

    def enter(name):
        """Type a name as a browser does: Enter is heard before the value."""
        with edit_readonly(field):
            field.value_input = name
        field.param.trigger("enter_pressed")
        field.value = name

    enter("bent")
    state.turns = {0: (0.0, 0.0, 30.0)}
    enter("raised")
    assert state.edits.poses == {"bent": POSE, "raised": SavedPose({"shoulder": (0, 0, 30)})}
    state.turns = {0: (0.0, 0.0, 60.0)}
    enter("raised")
    assert state.edits.poses["raised"] == SavedPose({"shoulder": (0, 0, 60)})


def test_a_frame_of_a_clip_is_saved_and_shown_again(posed):
    state, rig = posed.state, posed.state.rig
    state.param.update(clip=0, moving=True, playing=True)
    posed.view.time = 2.25  # it is shown over and over
    poses.save(posed, "raised")
    pose = state.edits.poses["raised"]
    assert pose == SavedPose(clip="wave", seconds=0.25)
    np.testing.assert_allclose(saved_pose(rig, pose), pose_at(rig.clips[0], 0.25))
    assert not state.playing
    state.param.update(moving=False)
    posed.view.time = 0.0
    poses.show(posed, "raised")
    assert (state.moving, state.playing, state.clip, posed.view.time) == (True, False, 0, 0.25)
    assert poses.shown_key(state) == "raised"


@pytest.mark.parametrize("values", [{"turns": {}}, {"moving": True, "clip": -1}])
def test_what_cannot_be_saved_says_why(posed, values):
    posed.state.param.update(**values)
    poses.save(posed, "nothing")
    assert "urn a joint, or pause a clip" in posed.state.message[1]
    assert not posed.state.edits.poses


def test_joints_that_share_a_name_are_not_saved(session, loop):
    rig = arm_rig()
    names = ("shoulder", "elbow", "elbow")
    loading.show_rig(session, replace(rig, skeleton=replace(rig.skeleton, names=names)))
    session.state.param.update(panel="pose", turns={2: (0.0, 0.0, 30.0)})
    poses.save(session, "wrist")
    assert "wo joints are called" in session.state.message[1]


def test_poses_follow_the_names_of_joints(posed):
    poses.save(posed, "bent")
    correct.rename(posed, 1, "cubit")
    assert posed.state.edits.poses == {"bent": SavedPose({"cubit": BENT[1]})}
    poses.show(posed, "bent")
    assert posed.state.turns == BENT


def test_edits_of_another_character_say_what_is_missing(posed):
    state = posed.state
    saved = {
        "other": SavedPose({"elbow": (0, 0, 50), "knee": (90, 0, 0)}),
        "run": SavedPose(clip="run", seconds=1),
    }
    correct.open_text(posed, Edits(poses=saved).to_json())
    assert poses.missing(state) == "Saved poses name what this character lacks: knee, run."
    poses.show(posed, "other")
    assert state.turns == {1: (0, 0, 50)}
    poses.show(posed, "run")
    assert not state.moving


def test_the_list_has_the_largest_stretch_before_and_after(posed, loop):
    state, rig = posed.state, posed.state.rig
    rows = draw(posed, pose_list.SAVED).select(Rows)[0]
    poses.save(posed, "bent")
    state.turns = {1: (0.0, 5.0, 0.0)}
    poses.save(posed, "hardly")
    loop.rest(posed)
    expected = {}
    for name, pose in state.edits.poses.items():
        factors = [
            slow_worst(rig, one, saved_pose(rig, pose)) for one in (rig.weights, state.weights)
        ]
        expected[name] = " → ".join(f"{one:.2f}" for one in factors)
    assert {name: note for name, note, _ in rows.rows if name != "wave"} == expected
    assert expected["bent"] != expected["hardly"]
    assert [bar for *_, bar in rows.rows] == sorted((bar for *_, bar in rows.rows), reverse=True)
    assert rows.rows[0][2] == 1
    before = state.stretches["file", False]
    correct.choose_file(posed, True)
    loop.rest(posed)
    assert state.stretches["file", False] is before, "the file's weights are as they were"
    for _, note, _ in rows.rows:
        assert len({*note.split(" → ")}) == 1
    order = poses.keys(state)
    rows.click(order.index(0))
    assert (state.moving, state.playing, posed.view.time) == (True, False, 1)
    poses.show_worst(posed)
    assert state.vertex == poses.worst_of(state, poses.NOW, 0).vertex


def test_without_the_files_weights_there_is_one_number(session, loop):
    session.state.param.update(resolution=16, graph_resolution=0, panel="pose")
    loading.show_rig(session, arm_rig().with_weights(None))
    loop.rest(session)
    assert all("→" not in note for _, note, _ in pose_list.rows(session.state))
    assert len(pose_list.rows(session.state)) == 1


def test_saved_poses_are_a_motion_that_stays_in_each(posed):
    state, rig = posed.state, posed.state.rig
    menu = next(one for one in draw(posed, CONTROLS).select(pmui.Select) if one.label == "Motion")
    assert "Saved poses" not in menu.options
    poses.save(posed, "bent")
    state.param.update(clip=0, moving=True)
    posed.view.time = 0.5
    poses.save(posed, "half")
    menu.value = "Saved poses"
    assert state.clip == POSES
    clip = chosen_clip(state)
    frames = clip.transforms
    np.testing.assert_allclose(frames[0], np.tile(np.eye(4), (3, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(frames[-1], frames[0], atol=1e-12)
    for place, pose in enumerate(state.edits.poses.values()):
        for seconds in (0.65, 1.15):
            moment = clip.sample(1.2 * place + seconds)
            np.testing.assert_allclose(moment, saved_pose(rig, pose), atol=1e-9)
    on_the_way = frames[clip.times < 1.2, :, :3, :3]
    np.testing.assert_allclose(np.linalg.det(on_the_way), 1, atol=1e-9)
    quarter = turned(rig, {1: tuple(0.5 * x for x in (0.0, 90.0, 0.0))})
    state.turns = {1: (0.0, 90.0, 0.0)}
    state.moving = False
    correct.correct(posed, replace(state.edits, poses={}))
    poses.save(posed, "square")
    state.clip = POSES
    np.testing.assert_allclose(chosen_clip(state).sample(0.3), quarter, atol=1e-9)
    poses.delete(posed)
    assert chosen_clip(state).duration > 0, "a motion without poses rests"


def test_a_motion_through_poses_keeps_what_clips_shift():
    rig = small_rig()
    joints = len(rig.skeleton.joints)
    lifted = np.tile(np.eye(4), (joints, 1, 1))
    lifted[:, 1, 3] = 0.5
    grown = rotate_joint(rig.skeleton, 3, "z", 50)
    grown[3:6, :3, :3] *= 1.5
    clip = Clip("lift", [0.0, 1.0], [lifted, grown])
    rig = replace(rig, clips=(clip,))
    motion = through_poses(rig, [lifted, grown])
    np.testing.assert_allclose(motion.sample(0.9), lifted, atol=1e-9)
    np.testing.assert_allclose(motion.sample(2.1), grown, atol=1e-9)
