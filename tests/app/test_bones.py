"""Swap bones on the page, or replace some by others: layers, one step of undo each."""

import numpy as np
import panel_material_ui as pmui
import pytest

from cutcell import Edits, JointEdit, Remapped
from cutcell_app.editing.brush.strokes import select
from cutcell_app.editing.correct.commands import choose_deform, choose_file
from cutcell_app.editing.select import bones
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import draw
from tests.app.loop import settled


@pytest.fixture
def from_file(bound, loop):
    choose_file(bound, True)
    settled(bound, loop)
    bound.state.param.update(joint=1, other_bone="wrist")
    return bound


def labelled(session, kind, label):
    return next(one for one in draw(session, bones.BONES).select(kind) if one.label == label)


def test_a_swap_exchanges_two_columns_of_the_whole_rig_and_is_undone(from_file, loop):
    state, before = from_file.state, from_file.state.weights
    labelled(from_file, pmui.Button, "Swap elbow with wrist").clicks += 1
    settled(from_file, loop)
    np.testing.assert_array_equal(state.weights, before[:, [0, 2, 1]])
    assert Edits.from_json(state.edits.to_json()) == state.edits
    keys.act(from_file, "undo")
    loop.rest(from_file)
    np.testing.assert_array_equal(state.weights, before)


def test_a_bone_is_replaced_at_the_selection_alone(from_file, loop):
    state, before = from_file.state, from_file.state.weights
    chosen = state.rig.mesh.vertices[:, 1] > 0
    select(from_file, chosen)
    bones.replace_bone(from_file)
    settled(from_file, loop)
    assert state.weights[chosen, 1].max() == 0
    np.testing.assert_array_equal(state.weights[chosen, 2], before[chosen][:, 1:].sum(axis=1))
    np.testing.assert_array_equal(state.weights[~chosen], before[~chosen])


def test_a_table_replaces_joints_and_lets_them_carry_weight(from_file, loop):
    state, before = from_file.state, from_file.state.weights
    choose_deform(from_file, [0, 1])
    settled(from_file, loop)
    labelled(from_file, pmui.TextInput, "Replace by table").value = "elbow <-> wrist"
    settled(from_file, loop)
    assert state.edits.layers[-1].content == Remapped({"elbow": "wrist", "wrist": "elbow"})
    assert state.edits.joints.get("wrist", JointEdit()).deform is not False
    np.testing.assert_array_equal(state.weights, before[:, [0, 2, 1]])


def test_what_cannot_be_exchanged_is_told(from_file):
    state, edits = from_file.state, from_file.state.edits
    state.with_children = True
    bones.swap(from_file)
    assert "of one branch" in state.message[1]
    state.other_bone = ""
    bones.swap(from_file)
    assert "choose another bone" in state.message[1].lower()
    bones.replace_by_table(from_file, "elbow -> knee")
    assert 'no joint "knee"' in state.message[1]
    assert state.edits == edits
