"""Joints that are moved on the page: what it makes of the weights, and of what is told."""

from dataclasses import replace

import numpy as np
import panel_material_ui as pmui
import pytest
import trimesh

import cutcell
from cutcell import Edits, JointEdit
from cutcell.errors import SkeletonError
from cutcell.rig import Skeleton, TriangleMesh
from cutcell_app.document import loading
from cutcell_app.editing.compute.limb import cross_section_centre
from cutcell_app.editing.correct import moving
from cutcell_app.editing.correct.moving_controls import PLACE
from cutcell_app.features.scenes import resolve
from cutcell_app.files.edits_file import from_text, to_text
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import column, draw
from tests.app.loop import settled
from tests.viewers.arm import WORLD, arm_rig

ELBOW = 1


def rested(session, loop):
    settled(session, loop)
    assert session.state.dragged is None


def the_same_as_bind(session, rig):
    state = session.state
    joints = rig.skeleton.joints.copy()
    for name, one in state.edits.joints.items():
        joints[rig.skeleton.names.index(name)] = one.position
    changed = replace(rig, skeleton=replace(rig.skeleton, joints=joints))
    fresh = cutcell.bind(changed, state.resolution)
    np.testing.assert_allclose(state.binding.weights, fresh.weights, rtol=0, atol=1e-9)


def drag(session, at, joint=ELBOW, done=False):
    """Send what the view's handle sends: a place in the scene."""
    scene = WORLD[:3, :3] @ at + WORLD[:3, 3]
    message = {"type": "move-joint", "joint": joint, "position": scene.tolist(), "done": done}
    session.view._handle_msg(message)


@pytest.fixture
def held(bound, loop):
    bound.state.param.update(joint=ELBOW, joint_handle=True)
    loop.rest(bound)
    return bound


def test_the_weights_follow_a_joint_while_it_is_dragged(held, loop):
    state, rig = held.state, arm_rig()
    before, steps = state.binding.weights, len(held.history)
    bones = resolve(state).actors["bones"].points
    assert held.view.last_sent("mover")["at"] == pytest.approx([0, 0, 0])
    fields = draw(held, column(PLACE)).select(pmui.TextInput)
    drag(held, [0.1, 0.05, 0])
    assert [field.value for field in fields] == ["0.1", "0.05", "0"]
    assert not np.array_equal(resolve(state).actors["bones"].points, bones)
    assert not state.edits
    loop.rest(held)
    on_the_way = resolve(state).actors["body"].colors
    assert not np.array_equal(state.dragged.binding.weights, before)
    for x in (0.2, 0.3, 0.4):
        drag(held, [x, 0.05, 0])
    drag(held, [0.4, 0.1, 0], done=True)
    assert state.edits == Edits({"elbow": JointEdit(position=(0.4, 0.1, 0))})
    assert [field.value for field in fields] == ["0.4", "0.1", "0"]
    assert held.view.last_sent("mover")["at"] == pytest.approx([0.4, 0, -0.1])
    rested(held, loop)
    the_same_as_bind(held, rig)
    assert not np.array_equal(resolve(state).actors["body"].colors, on_the_way)
    assert state.rig.skeleton.joints[ELBOW].tolist() == [0.4, 0.1, 0]
    assert len(held.history) == steps + 1, "one step a drag"
    keys.act(held, "undo")
    rested(held, loop)
    assert not state.edits
    assert np.array_equal(state.rig.skeleton.joints, rig.skeleton.joints)
    np.testing.assert_allclose(state.binding.weights, before, rtol=0, atol=1e-9)
    keys.act(held, "redo")
    rested(held, loop)
    the_same_as_bind(held, rig)
    keys.act(held, "reset")
    rested(held, loop)
    assert np.array_equal(state.rig.skeleton.joints, rig.skeleton.joints)


def test_what_is_left_while_it_is_dragged_is_as_it_was(held, loop):
    drag(held, [0.1, 0.05, 0])
    held.state.panel = "graph"
    assert held.state.dragged is None
    loop.rest(held)
    assert held.view.last_sent("mover") is None
    rested(held, loop)
    held.state.panel = "weights"
    drag(held, [0.1, 0.05, 0], joint=0)  # of a joint that is no longer chosen
    assert held.state.dragged is None


def test_where_no_joint_can_be_is_told(held, loop):
    drag(held, [0.1, 0.05, 0])
    drag(held, [1e6, 0, 0])
    assert "size away" in held.state.message[1]
    assert held.state.dragged is None
    moving.put(held, [np.nan, 0, 0])
    assert "X of position must be a number" in held.state.message[1]
    assert not held.state.edits
    assert np.array_equal(held.state.rig.skeleton.joints, arm_rig().skeleton.joints)


def test_numbers_put_a_joint_and_back(held, loop):
    section = draw(held, column(PLACE))
    fields, state = section.select(pmui.TextInput), held.state
    assert [field.value for field in fields] == ["0", "0", "0"]
    fields[0].value = "0.25"
    assert state.edits.joints["elbow"].position == (0.25, 0, 0)
    rested(held, loop)
    the_same_as_bind(held, arm_rig())
    fields[1].value = "far"
    assert state.message[1] == "Y must be a number, not 'far'."
    assert fields[1].value == "0"
    state.message = None
    assert from_text(to_text(state.edits)) == state.edits
    buttons = {button.label: button for button in section.select(pmui.Button)}
    moving.put(held, [0.25, 0.1, 0.1])
    buttons["Centre in limb"].clicks += 1
    assert state.rig.skeleton.joints[ELBOW] == pytest.approx([0.25, 0, 0], abs=0.02)
    buttons["Reset position"].clicks += 1
    assert not state.edits
    assert [field.value for field in fields] == ["0", "0", "0"]
    assert buttons["Reset position"].disabled
    state.joint = 0
    moving.put(held, [-5, 0, 0])
    held.work.after_a_pause(lambda: None, "rest")
    buttons["Centre in limb"].clicks += 1
    assert "not in the body" in state.message[1]


def pair():
    """Return a bar with a joint in the middle and one on each side."""
    beam = trimesh.creation.box(extents=(3.0, 0.6, 0.6)).subdivide_to_size(0.3)
    skeleton = Skeleton(
        [[0, 0, 0], [0.5, 0, 0], [1.2, 0, 0], [-0.5, 0, 0], [-1.2, 0, 0]], [-1, 0, 1, 0, 3],
        ("hips", "arm.L", "hand.L", "arm.R", "hand.R"),
    )  # fmt: skip
    return cutcell.Rig(TriangleMesh(beam.vertices, beam.faces), skeleton, world=WORLD)


def test_the_other_side_moves_along(session, loop):
    session.state.resolution = 16
    loading.show_rig(session, pair())
    loop.run_until(lambda: session.state.binding is not None)
    state = session.state
    state.param.update(joint=1, joint_handle=True)
    loop.rest(session)
    reports = session.view.last_sent("mover")["mirror"]
    assert np.abs(reports) == pytest.approx([1, 0, 0, 0])
    drag(session, [0.7, 0.1, 0.05], joint=1, done=True)
    assert {n: one.position for n, one in state.edits.joints.items()} == {
        "arm.L": (0.7, 0.1, 0.05), "arm.R": (-0.7, 0.1, 0.05),
    }  # fmt: skip
    rested(session, loop)
    the_same_as_bind(session, pair())
    moving.put_back(session)
    assert not state.edits
    state.mirrored = False
    assert session.view.last_sent("mover")["mirror"] is None
    moving.put(session, [0.7, 0, 0])
    assert list(state.edits.joints) == ["arm.L"]
    state.param.update(mirrored=True, joint=0)
    assert session.view.last_sent("mover")["mirror"] is None, "it is its own mirror image"


def test_the_middle_of_a_limb_is_not_of_what_lies_beside_it():
    arm, body = (trimesh.creation.cylinder(r, 4.0, sections=48) for r in (0.25, 1.0))
    away = np.array([1.4, 0, 0])
    vertices = np.concatenate([arm.vertices, body.vertices + away])
    faces = np.concatenate([arm.faces, body.faces + len(arm.vertices)])
    off = [0.15, -0.05, 0.3]
    rig = cutcell.Rig(
        TriangleMesh(vertices, faces), Skeleton([[0, 0, -1.5], off, [0, 0, 1.5]], [-1, 0, 1])
    )
    result = cross_section_centre(rig, 1)
    assert np.linalg.norm(result[:2]) < 0.02
    assert result[2] == pytest.approx(0.3, abs=0.05)
    outside = rig.with_joints([[0, 0, -1.5], [0.33, 0, 0], [0, 0, 1.5]])
    with pytest.raises(SkeletonError, match="not in the body"):
        cross_section_centre(outside, 1)
