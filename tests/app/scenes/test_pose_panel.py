"""The panel Pose, from state to scene."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cutcell
from cutcell.pose import axis_rotation
from cutcell_app.features.pose.errors import scene_error
from cutcell_app.features.pose.scene import VIEWS, error_of
from cutcell_app.features.scenes import resolve
from cutcell_app.features.state import PageState
from cutcell_app.looks.pose import angles_of, gizmo_part, rotation_of
from cutcell_app.widgets.changes import changes
from cutcell_lab.metrics import deformation_error
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.description import Description
from cutcell_viewers.error_scene import gap_between
from cutcell_viewers.pose_scene import joint_turns

angle = st.floats(-180, 180)


@pytest.fixture
def state(rig, binding):
    return PageState(rig=rig, binding=binding, joint=1, panel="pose")


@given(angle, angle, angle)
def test_angles_make_the_rotation_that_they_are_read_from(x, y, z):
    rotation = rotation_of((x, y, z))
    again = rotation_of(angles_of(rotation, (x, y, z)))
    np.testing.assert_allclose(again, rotation, atol=6e-3)


@given(angle, st.floats(-89, 89), angle)
def test_of_the_angles_that_make_a_rotation_the_nearest_are_taken(x, y, z):
    result = np.array(angles_of(rotation_of((x, y, z)), (x, y, z)))
    off = (result - (x, y, z) + 180) % 360 - 180
    assert np.abs(result).max() <= 180
    assert np.abs(off).max() < 4  # within rounding, which near the pole weighs most


def test_a_quarter_turn_is_read_though_two_axes_fall_together():
    for y in (90, -90):
        rotation = rotation_of((20, y, 50))
        np.testing.assert_allclose(rotation_of(angles_of(rotation)), rotation, atol=6e-3)


def test_a_ghost_is_seen_through_and_a_neighbour_has_a_view(state):
    assert "rival" not in resolve(state).actors
    state.rival = "ghost"
    scene = resolve(state)
    assert 0 < scene.actors["rival"].opacity < 1
    assert scene.actors["rival"].behind
    assert scene.views == ()
    state.rival = "beside"
    scene = resolve(state)
    assert scene.views == VIEWS
    assert (scene.actors["body"].view, scene.actors["rival"].view) == (0, 1)
    assert scene.actors["bones"].view is None


def test_without_the_files_weights_there_is_nothing_to_compare(rig, binding):
    bare = rig.with_weights(None)
    state = PageState(rig=bare, binding=binding, panel="pose", rival="beside", heat=True)
    scene = resolve(state)
    assert "rival" not in scene.actors
    assert "mixed by weight" in scene.legend.title  # the colours of the weights, not of an error


def test_the_error_is_told_and_coloured(state, rig, binding):
    state.heat = True
    assert error_of(state) == (0.0, 0.0)
    state.turns = {1: (0, 40, 0)}
    scene = resolve(state)
    lengths = gap_between(rig, binding.weights, rig.weights).lengths(scene.pose)
    rms, greatest = error_of(state)
    assert rms == pytest.approx(np.sqrt(np.square(lengths).mean()))
    assert greatest == pytest.approx(float(lengths.max()))
    body = scene.actors["body"]
    assert body.apart is not None
    assert body.limits[1] >= np.quantile(lengths, 0.99)
    assert scene.legend.high.endswith("mm")


def test_dual_quaternions_move_the_same_weights_and_the_error_with_them(state, rig, binding):
    state.param.update(heat=True, turns={1: (0, 120, 0)})
    assert "blending" not in changes(Description(), resolve(state), set())
    linear = resolve(state), error_of(state)
    state.blending = "dual"
    scene, error = resolve(state), error_of(state)
    message = changes(linear[0], scene, set(scene.actors))
    assert message["blending"] == "dual"
    assert "pose" not in message
    assert not any({"points", "skin", "apart"} & part.keys() for part in message["actors"].values())
    body = scene.actors["body"]
    expected = cutcell.dual_quaternion_skinning(body.points, binding.weights, scene.pose)
    np.testing.assert_allclose(body.points_in(scene.pose, scene.blending), expected, atol=1e-5)
    apart = expected - cutcell.dual_quaternion_skinning(body.points, rig.weights, scene.pose)
    unit = body.apart.unit
    assert error[1] == pytest.approx(unit * np.linalg.norm(apart, axis=1).max(), rel=1e-3)
    assert error != linear[1]
    state.panel = "compare"
    assert resolve(state).blending == "dual"
    for panel in ("check", "weights"):
        state.panel = panel
        assert resolve(state).blending == "linear"


def test_the_error_of_a_motion_is_known_once_it_was_measured(state, binding):
    state.param.update(moving=True, clip=0, heat=True)
    assert error_of(state) is None
    state.motion_error = (1.5, 40.0, 28.0)
    assert error_of(state) == (1.5, 40.0)
    assert resolve(state).actors["body"].limits == (0.0, 30.0)


def test_a_small_turn_streams_nothing_but_the_pose(state):
    state.param.update(heat=True, rival="beside", turns={1: (0, 40, 0)})
    before = resolve(state)
    state.turns = {1: (0, 40.5, 0)}
    after = resolve(state)
    for name, actor in before.actors.items():
        for field in ("points", "scalars", "skin", "apart"):
            assert getattr(after.actors[name], field) is getattr(actor, field), (name, field)


def test_the_rings_are_there_while_a_joint_can_be_turned(state):
    part = gizmo_part(state)
    assert part["joint"] == 1
    assert part["below"].tolist() == [1, 2]
    np.testing.assert_allclose(part["centre"], [0, 0, 0], atol=1e-12)
    state.moving = True
    assert gizmo_part(state) is None
    state.param.update(moving=False, panel="graph")
    assert gizmo_part(state) is None


def test_worst_turns_are_about_the_axes_that_the_page_turns_about(rig):
    other = np.random.default_rng(3).random(rig.weights.shape)
    other /= other.sum(axis=1, keepdims=True)
    other[:5] = 0  # these stand still
    errors = scene_error(rig, rig.weights, other)
    worst = errors.worst(1)[0]
    rotations = joint_turns(rig, {worst.joint: axis_rotation(worst.axis, 30)})
    pose = pose_in_scene(rig, cutcell.forward_kinematics(rig.skeleton, rotations))
    lengths = gap_between(rig, rig.weights, other).lengths(pose)
    assert worst.largest == pytest.approx((lengths.max() / 10) ** 2, rel=1e-3)
    # The arm's space has z up and the scene y: the same turns, called by other names.
    plain = deformation_error(rig, rig.weights, other)
    np.testing.assert_allclose(errors.turn_mean[:, 1], plain.turn_mean[:, 2], rtol=1e-9)
    assert errors.mean == pytest.approx(plain.mean)
