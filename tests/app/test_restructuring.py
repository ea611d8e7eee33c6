"""Joints of a fitted skeleton are added, removed and hung on others on the page."""

import numpy as np
import panel_material_ui as pmui
import pytest

import cutcell
from cutcell.editing import Computed, Filled, JointEdit, Layer, Mask, Painted
from cutcell.rig import Rig, Skeleton
from cutcell_app.document import loading
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.correct import structure
from cutcell_app.editing.correct.structure_controls import NOTHING, STRUCTURE
from cutcell_app.shell.session import export, keys
from cutcell_app.widgets.controls import draw
from tests.viewers.arm import arm_rig


def chain(names=("a", "b", "c")):
    """Edits that give a mesh a chain of joints along x."""
    above = ["", *names[:-1]]
    return cutcell.Edits(
        {
            name: JointEdit(added=True, parent=parent, position=(0.3 * k, 0.0, 0.0))
            for k, (name, parent) in enumerate(zip(names, above, strict=True))
        }
    )


@pytest.fixture
def fitted(session, loop):
    session.state.resolution = 16
    loading.show_rig(session, Rig(arm_rig().mesh, Skeleton([], []), name="statue"))
    loop.run_until(lambda: session.state.built_graph is not None)
    correct.correct(session, chain())
    rebound(session, loop)
    session.state.mirrored = False
    session.history.part()  # what follows is a step of its own
    return session


def rebound(session, loop):
    loop.run_until(lambda: session.state.binding is not None and not session.work.busy)


def hierarchy(session):
    skeleton = session.state.rig.skeleton
    return {
        name: skeleton.names[parent] if parent >= 0 else ""
        for name, parent in zip(skeleton.names, skeleton.parents, strict=True)
    }


def test_a_joint_is_added_in_the_middle_of_a_bone(fitted, loop):
    state = fitted.state
    state.joint = 0
    structure.add(fitted)
    rebound(fitted, loop)
    assert hierarchy(fitted) == {"a": "", "a_1": "a", "b": "a_1", "c": "b"}
    names = state.rig.skeleton.names
    assert names[state.joint] == "a_1"
    np.testing.assert_allclose(state.rig.skeleton.joints[state.joint], [0.15, 0, 0], atol=1e-6)
    fresh = cutcell.bind((state.rig.mesh, state.rig.skeleton), state.resolution)
    np.testing.assert_allclose(state.weights, fresh.weights, atol=1e-9)
    keys.act(fitted, "undo")
    rebound(fitted, loop)
    assert hierarchy(fitted) == {"a": "", "b": "a", "c": "b"}


def test_behind_a_last_joint_another_one_begins(fitted, loop):
    state = fitted.state
    state.joint = 2
    structure.add(fitted)
    structure.add(fitted)
    rebound(fitted, loop)
    assert hierarchy(fitted) == {"a": "", "b": "a", "c": "b", "c_1": "c", "c_2": "c_1"}
    x = [joint[0] for joint in state.rig.skeleton.joints]
    np.testing.assert_allclose(x, [0, 0.3, 0.6, 0.75, 0.825], atol=1e-6)


def test_what_hung_on_a_removed_joint_hangs_on_its_parent(fitted, loop):
    state = fitted.state
    rigid = Layer(Filled({"b": 1.0}), Mask(part=0))
    rows = Layer(Painted([3, 4], ["a", "b", "c"], [[0.25, 0.75, 0], [0, 0, 1]]))
    reach = Layer(Computed(gain={"b": 2.0, "c": 3.0}))
    correct.correct(fitted, cutcell.Edits(chain().joints, layers=[reach, rigid, rows]))
    state.joint = 1
    structure.remove(fitted)
    rebound(fitted, loop)
    assert hierarchy(fitted) == {"a": "", "c": "a"}
    assert state.rig.skeleton.names[state.joint] == "a"
    reach, rigid, rows = (layer.content for layer in state.edits.layers)
    assert reach == Computed(gain={"c": 3.0})
    assert rigid == Filled({"a": 1.0})
    assert rows == Painted([3, 4], ["a", "c"], [[1, 0], [0, 1]])
    assert state.weights.shape[1] == 2


def test_a_root_leaves_roots_and_the_last_joint_stays(fitted, loop):
    state = fitted.state
    rigid = Layer(Filled({"a": 1.0}), Mask(part=0))
    rows = Layer(Painted([3, 4], ["a", "c"], [[1, 0], [0.5, 0.5]]))
    correct.correct(fitted, cutcell.Edits(chain().joints, layers=[rigid, rows]))
    state.joint = 0
    structure.remove(fitted)
    rebound(fitted, loop)
    assert hierarchy(fitted) == {"b": "", "c": "b"}
    (layer,) = state.edits.layers  # no joint takes over the others
    assert layer.content == Painted([4], ["c"], [[1]])
    state.joint = 1
    structure.remove(fitted)
    structure.remove(fitted)
    assert '"b" is the only joint' in state.message[1]
    assert hierarchy(fitted) == {"b": ""}


def test_a_joint_hangs_on_another_but_never_on_what_hangs_on_it(fitted, loop):
    state = fitted.state
    state.joint = 2
    assert structure.may_hang_on(state.rig, 2) == ["a", "b"]
    assert structure.may_hang_on(state.rig, 0) == []
    structure.hang_on(fitted, "a")
    rebound(fitted, loop)
    assert hierarchy(fitted) == {"a": "", "b": "a", "c": "a"}
    structure.hang_on(fitted, "")
    rebound(fitted, loop)
    assert hierarchy(fitted)["c"] == ""
    state.joint = 0
    before = state.edits
    structure.hang_on(fitted, "b")  # no menu offers that
    assert "has a cycle" in state.message[1]
    assert state.edits == before


def test_the_other_side_gets_the_same(fitted, loop):
    state = fitted.state
    middle = state.rig.mesh.bounds.mean(axis=0)
    places = {"hips": 0.0, "left": 0.2, "right": -0.2}
    sides = {
        name: JointEdit(
            added=True,
            parent="" if name == "hips" else "hips",
            position=tuple((middle + np.array([aside, abs(aside) / 4, 0])).tolist()),
        )
        for name, aside in places.items()
    }
    correct.correct(fitted, cutcell.Edits(sides))
    state.param.update(mirrored=True, joint=1)
    structure.add(fitted)
    assert set(hierarchy(fitted)) == {"hips", "left", "left_1", "right", "right_1"}
    one, other = (state.rig.skeleton.names.index(name) for name in ("left_1", "right_1"))
    gap = state.rig.skeleton.joints[[one, other]] - middle
    np.testing.assert_allclose(gap[0] * [-1, 1, 1], gap[1], atol=1e-5)
    for on, across in (("hips", "hips"), ("right", "left"), ("left", "right"), ("", "")):
        structure.hang_on(fitted, on)
        assert hierarchy(fitted)["left_1"] == on
        assert hierarchy(fitted)["right_1"] == across
    structure.remove(fitted)
    assert set(hierarchy(fitted)) == {"hips", "left", "right"}
    state.joint = state.rig.skeleton.names.index("left")
    structure.hang_on(fitted, "right")
    assert state.message is None
    assert hierarchy(fitted) == {"hips": "", "left": "right", "right": "hips"}


def test_the_controls_show_and_change_it(fitted, loop, tmp_path):
    state = fitted.state
    state.joint = 2
    panel = draw(fitted, STRUCTURE)
    (menu,) = panel.select(pmui.Select)
    add, remove = panel.select(pmui.Button)
    assert menu.options == [NOTHING, "a", "b"]
    assert menu.value == "b"
    menu.value = "a"
    rebound(fitted, loop)
    assert hierarchy(fitted)["c"] == "a"
    add.clicks += 1
    assert hierarchy(fitted)["c_1"] == "c"
    assert menu.value == "c"
    remove.clicks += 1
    assert menu.value == "a"  # of the joint that it hung on, which is chosen now
    rebound(fitted, loop)
    got = []
    export.export_bound(fitted, lambda name, content: got.append((name, content)))
    loop.run_until(lambda: got)
    (tmp_path / got[0][0]).write_bytes(got[0][1])
    result = cutcell.load(tmp_path / got[0][0]).skeleton
    assert result.names == state.rig.skeleton.names
    np.testing.assert_array_equal(result.parents, state.rig.skeleton.parents)


def test_joints_of_a_file_are_added_removed_and_hung_elsewhere(bound, loop):
    state = bound.state
    state.param.update(mirrored=False, joint=1)
    assert hierarchy(bound) == {"shoulder": "", "elbow": "shoulder", "wrist": "elbow"}
    structure.add(bound)
    rebound(bound, loop)
    assert hierarchy(bound)["wrist"] == "elbow_1"
    assert state.edits.joints["wrist"] == JointEdit(parent="elbow_1")
    state.joint = state.rig.skeleton.names.index("elbow")
    correct.rename(bound, state.joint, "bend")
    structure.remove(bound)
    rebound(bound, loop)
    assert hierarchy(bound) == {"shoulder": "", "elbow_1": "shoulder", "wrist": "elbow_1"}
    assert state.edits.removed == ("elbow",)
    assert state.rig.skeleton.names[state.joint] == "shoulder"
    state.joint = state.rig.skeleton.names.index("wrist")
    structure.hang_on(bound, "shoulder")
    rebound(bound, loop)
    assert hierarchy(bound)["wrist"] == "shoulder"
    got = []
    export.export_bound(bound, lambda name, content: got.append(content))
    loop.run_until(lambda: got)


def test_joints_that_share_a_name_are_refused(bound, loop):
    state = bound.state
    twice = state.rig.skeleton.names[:2] + state.rig.skeleton.names[:1]
    rig = Rig(state.rig.mesh, Skeleton(state.rig.skeleton.joints, [-1, 0, 1], twice))
    loading.show_rig(bound, rig)
    rebound(bound, loop)
    state.joint = 2
    structure.hang_on(bound, twice[0])
    assert "wo joints are called" in state.message[1]
    structure.remove(bound)
    assert not state.edits
