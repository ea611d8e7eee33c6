"""A mesh without a skeleton gets one on the page: chosen, dragged, undone, told in the address."""

import numpy as np
import panel_material_ui as pmui
import pytest

import cutcell
from cutcell_app.document import loading
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.correct import moving, templates
from cutcell_app.editing.correct.joint_controls import JOINTS
from cutcell_app.editing.correct.template_controls import CHANGED, NONE, SKELETON, chosen_template
from cutcell_app.features.scenes import resolve
from cutcell_app.files.edits_file import to_text
from cutcell_app.shell.session import export, keys
from cutcell_app.widgets.controls import draw
from tests.app.loop import settled
from tests.viewers.arm import arm_rig, bare_arm


@pytest.fixture
def fitted(bare, loop):
    bare.section = draw(bare, SKELETON)
    (bare.menu,) = bare.section.select(pmui.Select)
    bare.menu.value = "Chain"
    loop.run_until(lambda: bare.state.binding is not None)
    settled(bare, loop)
    return bare


def test_a_template_is_fitted_and_bound(fitted, loop):
    state = fitted.state
    assert state.panel == "weights"
    assert state.joint_handle
    assert state.rig.skeleton.names == tuple(f"bone.{n}" for n in range(1, 6))
    assert state.weights.shape == (len(state.rig.mesh.vertices), 5)
    assert "bones" in resolve(state).actors
    assert fitted.view.last_sent("bones")["names"][0] == "bone.1"
    assert chosen_template(state) == fitted.menu.value == "Chain"


def test_its_joints_can_be_dragged(fitted, loop):
    state = fitted.state
    before = state.binding.weights
    state.joint = 2
    moving.put(fitted, [0.1, 0.05, 0.0])
    loop.run_until(lambda: state.binding is not None and state.binding.weights is not before)
    settled(fitted, loop)
    assert state.rig.skeleton.joints[2].tolist() == [0.1, 0.05, 0.0]
    fresh = cutcell.bind((state.rig.mesh, state.rig.skeleton), state.resolution)
    np.testing.assert_allclose(state.binding.weights, fresh.weights, rtol=0, atol=1e-9)
    moving.put_back(fitted)  # there is nowhere that it was before
    assert state.rig.skeleton.joints[2].tolist() == [0.1, 0.05, 0.0]


def test_undo_takes_it_out_and_redo_puts_it_in(fitted, loop):
    state = fitted.state
    keys.act(fitted, "undo")
    loop.run_until(lambda: state.built_graph is not None)
    settled(fitted, loop)
    assert state.bare
    assert state.binding is None
    assert fitted.menu.value == NONE
    keys.act(fitted, "redo")
    loop.run_until(lambda: state.binding is not None)
    settled(fitted, loop)
    assert state.weights.shape[1] == 5
    assert state.panel == "weights"


def test_the_menu_takes_it_out_and_puts_another_in(fitted, loop):
    state = fitted.state
    fitted.menu.value = "Snake"
    loop.run_until(lambda: state.weights is not None and state.weights.shape[1] == 12)
    settled(fitted, loop)
    fitted.menu.value = NONE
    loop.run_until(lambda: state.built_graph is not None)
    settled(fitted, loop)
    assert state.bare
    assert not state.edits
    assert state.panel == "graph"


def test_what_cannot_be_fitted_is_told(fitted, loop):
    fitted.menu.value = "Hand"
    loop.run_until(lambda: fitted.state.message is not None)
    assert "three fingers were found" in fitted.state.message[1]
    assert fitted.menu.value == "Chain"
    assert fitted.state.weights is not None


def test_an_address_brings_it_back(fitted, session, loop):
    state, joints = fitted.state, fitted.state.rig.skeleton.joints
    said = to_text(state.edits)
    loading.show_rig(fitted, bare_arm(), edits=said, bone="bone.4")
    loop.run_until(lambda: state.binding is not None)
    settled(fitted, loop)
    np.testing.assert_array_equal(state.rig.skeleton.joints, joints)
    assert state.joint == 3
    assert state.panel == "weights"


def test_export_writes_it(fitted, loop, tmp_path):
    got = []
    export.export_bound(fitted, lambda name, content: got.append((name, content)))
    loop.run_until(lambda: got)
    name, content = got[0]
    (tmp_path / name).write_bytes(content)
    result = cutcell.load(tmp_path / name)
    assert name.endswith(".glb")
    assert result.skeleton.names == fitted.state.rig.skeleton.names
    np.testing.assert_allclose(result.skeleton.joints, fitted.state.rig.skeleton.joints, atol=1e-5)
    np.testing.assert_allclose(result.weights.sum(axis=1), 1, atol=1e-5)


def test_a_skeleton_of_ones_own_is_called_so(fitted):
    joints = dict(fitted.state.edits.joints)
    joints["tip"] = joints.pop("bone.5")
    fitted.state.edits = cutcell.Edits(joints)
    assert chosen_template(fitted.state) == fitted.menu.value == CHANGED


def test_the_menu_is_only_for_meshes_without_a_skeleton(fitted, loop):
    loading.show_rig(fitted, arm_rig())
    loop.run_until(lambda: fitted.state.binding is not None)
    assert not fitted.section.visible
    assert templates.is_template({"hand", *(f"thumb.{n}" for n in (1, 2, 3))}, "hand") is False


def joint_fields(session):
    return {field.label: field for field in draw(session, JOINTS).select(pmui.TextInput)}


def test_a_joint_is_renamed(fitted, loop):
    state, weights = fitted.state, fitted.state.weights
    fitted.history.part()  # what follows is a step of its own
    state.joint = 1
    field = joint_fields(fitted)["Name"]
    assert field.value == "bone.2"
    field.value = "elbow"
    loop.run_until(lambda: state.binding is not None)
    settled(fitted, loop)
    assert state.rig.skeleton.names[1] == field.value == "elbow"
    assert state.rig.skeleton.parents.tolist() == [-1, 0, 1, 2, 3]
    np.testing.assert_array_equal(state.weights, weights)
    assert fitted.view.last_sent("bones")["names"][1] == "elbow"
    for wrong, says in (("bone.1", "already"), (" ", "needs a name")):
        field.value = wrong
        assert says in state.message[1]
        assert field.value == "elbow"
    keys.act(fitted, "undo")
    loop.run_until(lambda: state.binding is not None)
    loop.rest(fitted)
    assert state.rig.skeleton.names[1] == "bone.2"


def test_a_joint_of_a_file_is_renamed(bound, loop):
    state = bound.state
    correct.correct(
        bound,
        cutcell.Edits(
            layers=[
                cutcell.Layer(cutcell.Computed(gain={"elbow": 2.0})),
                cutcell.Layer(cutcell.Filled({"elbow": 1}), cutcell.Mask(part=0)),
                cutcell.Layer(cutcell.Painted([3], ["elbow"], [[1]])),
            ]
        ),
    )
    loop.rest(bound)
    correct.rename(bound, 1, "bend")
    loop.run_until(lambda: state.binding is not None and not bound.work.busy)
    assert state.rig.skeleton.names == ("shoulder", "bend", "wrist")
    assert state.edits.joints == {"bend": cutcell.JointEdit(was="elbow")}
    assert [one.content.joints_named() for one in state.edits.layers] == [("bend",)] * 3
    assert state.rig.weights is not None
    correct.rename(bound, 1, "elbow")
    assert state.edits.joints == {}
    assert state.edits.reach.gain == {"elbow": 2.0}
