"""Edits on the page: what they make of the weights, and where they are kept."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import panel_material_ui as pmui
import pytest
import trimesh

import cutcell
from cutcell import (
    Attached,
    Computed,
    Edits,
    Filled,
    FromFile,
    JointEdit,
    Layer,
    Locked,
    Mask,
    Painted,
)
from cutcell.rig import TriangleMesh
from cutcell.rig.deform_joints import deform_joints
from cutcell.runtime.display import count
from cutcell_app.derive.memo import Memo
from cutcell_app.document import loading, look
from cutcell_app.document.address import from_query
from cutcell_app.document.document import put
from cutcell_app.document.opening import Request
from cutcell_app.document.recording import query
from cutcell_app.editing.compute.stack import painted_vertices
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.correct import moving
from cutcell_app.editing.correct.component_controls import COMPONENTS
from cutcell_app.editing.correct.joint_controls import JOINTS
from cutcell_app.editing.correct.joints import joint_rows
from cutcell_app.editing.layers import commands as layers
from cutcell_app.features.inspector.facts import vertex_facts
from cutcell_app.features.learn import steps as lesson
from cutcell_app.features.scenes import resolve
from cutcell_app.files.edits_file import MAX_IN_ADDRESS, from_text, to_text
from cutcell_app.shell.export_controls import BASE, changes_of, loss
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import draw
from cutcell_app.widgets.joint_tree import JointTree
from cutcell_app.widgets.rows import Rows
from tests.app.loop import check_bound_as_by_core, settled
from tests.viewers.arm import arm_rig

PART = Mask(part=3)
REACH = Layer(Computed(gain={"shoulder": 2.0}, radius={"shoulder": 0.4}), name="Reach of joints")
ALL = Edits(
    layers=[
        REACH,
        Layer(Painted([7], ["shoulder", "wrist"], [[0.5, 0.5]])),
        Layer(Locked(["wrist"])),
    ]
)
SOME = Mask(vertices=range(0, 40, 2))


@pytest.mark.parametrize("falloff", ["rig", "paper"])
@pytest.mark.parametrize(
    "edits",
    [
        ALL,
        Edits(joints={"elbow": JointEdit(deform=False)}),
        Edits(layers=[Layer(Filled({"elbow": 1}), PART)]),
        Edits(layers=[Layer(Computed(as_skin=True), PART)]),
        Edits(
            layers=[Layer(Computed({"resolution": 20}), SOME, opacity=0.5), Layer(FromFile(), PART)]
        ),
        Edits(base="file", layers=[Layer(Computed({"method": "paper"}), SOME)]),
    ],
)
def test_weights_are_those_of_bind(bound, loop, edits, falloff):
    graph = bound.state.binding.graph
    correct.correct(bound, edits)
    settled(bound, loop)
    check_bound_as_by_core(bound, arm_rig())
    assert bound.state.binding.graph is graph
    bound.state.falloff = falloff
    settled(bound, loop)
    alpha = {"alpha": 0.5} if falloff == "paper" else {}
    options = {"falloff": falloff, "leaf": "fit", **alpha}
    fresh = cutcell.bind(arm_rig(), 16, edits=edits, **options)
    np.testing.assert_allclose(bound.state.binding.weights, fresh.weights, rtol=0, atol=1e-9)


def test_they_stay_with_another_resolution_and_are_undone_in_one_step(bound, loop):
    plain = bound.state.binding.weights
    correct.correct(bound, ALL)
    settled(bound, loop)
    corrected = bound.state.binding.weights
    bound.state.resolution = 20
    settled(bound, loop)
    check_bound_as_by_core(bound, arm_rig())
    keys.act(bound, "undo")
    settled(bound, loop)
    assert np.array_equal(bound.state.binding.weights, corrected)
    keys.act(bound, "undo")
    settled(bound, loop)
    assert not bound.state.edits
    assert np.array_equal(bound.state.binding.weights, plain)
    assert not bound.history.can_undo
    keys.act(bound, "redo")
    settled(bound, loop)
    assert bound.state.edits == ALL
    keys.act(bound, "reset")
    settled(bound, loop)
    assert not bound.state.edits


def test_a_joint_that_is_left_out_comes_back_as_the_file_has_it(bound, loop):
    first = bound.state.rig
    correct.correct_joint(bound, 2, deform=False)
    settled(bound, loop)
    assert bound.state.edits.joints == {"wrist": JointEdit(deform=False)}
    assert not bound.state.rig.skeleton.deform[2]
    assert not bound.state.binding.weights[:, 2].any()
    correct.correct_joint(bound, 2, deform=True)
    assert not bound.state.edits
    assert np.array_equal(bound.state.rig.skeleton.deform, first.skeleton.deform)
    correct.correct_joint(bound, 0, gain=99)
    assert "Gain must be" in bound.state.message[1]
    assert not bound.state.edits


def test_what_cannot_be_is_told_and_not_taken(bound, loop):
    rig = arm_rig()
    correct.choose_deform(bound, [])
    assert "No joint is left" in bound.state.message[1]
    correct.open_text(bound, '{"joints": {"tail": {"deform": true}}}')
    assert 'no joint "tail"' in bound.state.message[1]
    correct.open_text(bound, "no")
    assert "no JSON" in bound.state.message[1]
    assert not bound.state.edits
    # What only the weights tell is taken back with the weights that there are.
    correct.correct(bound, Edits(layers=[Layer(Attached())]))
    loop.rest(bound)
    assert "None is left" in bound.state.message[1] or "none is left" in bound.state.message[1]
    assert not bound.state.edits
    assert not bound.history.can_undo
    alone = to_text(Edits(layers=[Layer(Attached())]))
    loading.show_rig(bound, arm_rig(), edits=alone)
    loop.run_until(lambda: bound.state.binding is not None)
    assert not bound.state.edits
    loading.show_rig(bound, rig.with_weights(None))
    loop.run_until(lambda: bound.state.binding is not None)
    correct.correct_joint(bound, 0, locked=True)
    assert "no weights of its own" in bound.state.message[1]
    twice = replace(rig, skeleton=replace(rig.skeleton, names=("a", "b", "a")))
    loading.show_rig(bound, twice)
    correct.correct_joint(bound, 2, gain=2.0)
    assert "two joints are called" in bound.state.message[1].lower()


def test_a_lock_that_overrules_a_part_is_warned_of(bound, loop):
    rigid = Layer(Filled({"elbow": 1}), PART)
    correct.correct(bound, Edits(layers=[rigid, Layer(Locked(["wrist"]))]))
    settled(bound, loop)
    reports = [link.text for link in bound.state.warnings if "vertex 3 " in link.text]
    assert len(reports) == 1
    assert "elbow" in reports[0]
    assert "wrist" in reports[0]
    correct.correct(bound, Edits(layers=[rigid]))
    settled(bound, loop)
    assert not any("vertex 3 " in link.text for link in bound.state.warnings)


def test_all_parts_start_from_the_files_weights(bound, loop):
    computed = bound.state.binding.weights
    assert "Computed" in changes_of(bound.state)
    assert not correct.uses_file(bound.state)
    correct.choose_file(bound, True)
    settled(bound, loop)
    assert correct.uses_file(bound.state)
    np.testing.assert_array_equal(bound.state.binding.weights, bound.state.rig.weights)
    check_bound_as_by_core(bound, arm_rig())
    assert "Computed" not in changes_of(bound.state)
    correct.choose_file(bound, False)
    settled(bound, loop)
    np.testing.assert_allclose(bound.state.binding.weights, computed)
    loading.show_rig(bound, arm_rig().with_weights(None))
    loop.run_until(lambda: bound.state.binding is not None)
    assert "file's" not in changes_of(bound.state)


def test_the_choice_above_the_export_is_made_of_what_is_corrected(bound, loop):
    (whose,) = draw(bound, BASE).select(pmui.RadioButtonGroup)
    assert (whose.value, whose.visible, whose.disabled) == (False, True, False)
    whose.value = True
    settled(bound, loop)
    assert correct.uses_file(bound.state)
    correct.overrule(bound, 3, {2: 1.0})
    settled(bound, loop)
    together = len(painted_vertices(bound.state.edits))
    painted = f"{count(together, 'vertex', 'differ')} from the file: Painted {together}."
    assert changes_of(bound.state) == painted
    assert whose.value is True
    correct.clear(bound)
    settled(bound, loop)
    assert whose.value is False
    loading.show_rig(bound, arm_rig().with_weights(None))
    assert not whose.visible


def opened_file(session, loop, tmp_path):
    """Open a file of a person's own, which has weights."""
    path = tmp_path / "own.glb"
    cutcell.save(path, arm_rig())
    session.state.param.update(resolution=16, graph_resolution=0)
    loading.load_files(session, [path])
    loop.run_until(lambda: session.state.binding is not None)
    return session.state


def test_a_persons_file_opens_with_its_own_weights(session, loop, tmp_path):
    state = opened_file(session, loop, tmp_path)
    np.testing.assert_array_equal(state.binding.weights, state.rig.weights)
    assert "unchanged" in changes_of(state)
    assert "edits=" not in query(session)
    correct.choose_file(session, False)
    settled(session, loop)
    address = query(session)
    loading.arrive(session, f"?{address}", Request("~"))
    loop.rest(session)
    assert (state.edits.base, query(session)) == ("computed", address)
    correct.clear(session)
    assert state.edits.base == "file"
    correct.choose_file(session, False)
    keys.reset(session)
    assert state.edits.base == "file"


def test_an_export_says_that_it_replaces_more_than_was_edited(session, loop, tmp_path):
    state = opened_file(session, loop, tmp_path)
    layers.put_rows(session, np.array([3]), np.array([[0.0, 0.0, 1.0]]), "Fill wrist")
    settled(session, loop)
    assert not loss(state)
    assert "Fill wrist" in changes_of(state)
    correct.choose_file(session, False)
    settled(session, loop)
    differs = np.abs(state.binding.weights - state.rig.weights).max(axis=1) > 1e-9
    differs[3] = False
    assert f" {differs.sum()} vertices" in loss(state)


def test_single_vertices_get_the_files_weights(bound, loop):
    which, before = np.array([3, 30]), bound.state.binding.weights
    layers.take_from_file(bound, which)
    settled(bound, loop)
    weights = bound.state.binding.weights
    np.testing.assert_allclose(weights[which], bound.state.rig.weights[which], atol=1e-12)
    others = np.delete(np.arange(len(weights)), which)
    np.testing.assert_array_equal(weights[others], before[others])
    check_bound_as_by_core(bound, arm_rig())


def test_an_address_brings_them_back(bound, loop):
    correct.correct(bound, ALL)
    settled(bound, loop)
    said = from_query(bound.view.last_sent("address"), bound.state)[1]["edits"]
    assert from_text(said) == ALL
    loading.show_rig(bound, arm_rig(), edits=said)
    assert bound.state.edits == ALL
    settled(bound, loop)
    check_bound_as_by_core(bound, arm_rig())
    for wrong in ("nothing", to_text(Edits(joints={"tail": JointEdit(deform=True)}))):
        loading.show_rig(bound, arm_rig(), edits=wrong)
        loop.rest(bound)
        assert "were not applied" in bound.state.message[1]
        assert not bound.state.edits


def test_what_an_address_has_no_room_for_is_kept_by_the_server(bound, loop):
    rng = np.random.default_rng(1)
    count = len(arm_rig().mesh.vertices)
    painting = Painted(range(count), ("shoulder", "elbow", "wrist"), rng.random((count, 3)))
    many = Edits(layers=[Layer(painting)])
    correct.correct(bound, many)
    settled(bound, loop)
    said = from_query(bound.view.last_sent("address"), bound.state)[1]["edits"]
    assert said.startswith("~")
    assert len(to_text(many)) > MAX_IN_ADDRESS > len(said)
    correct.clear(bound)
    settled(bound, loop)
    loading.show_rig(bound, arm_rig(), edits=said)
    settled(bound, loop)
    assert bound.state.edits == many
    check_bound_as_by_core(bound, arm_rig())
    loading.show_rig(bound, arm_rig(), edits="~gone")
    loop.rest(bound)
    assert "no longer has them" in bound.state.message[1]


def test_they_are_saved_and_opened(bound, loop, monkeypatch):
    offered = []
    monkeypatch.setattr(bound.view, "offer", lambda *file: offered.append(file))
    correct.correct(bound, ALL)
    correct.save(bound)
    correct.clear(bound)
    ((name, content),) = offered
    assert name == "arm.layers.json"
    correct.open_text(bound, content.decode())
    assert bound.state.edits == ALL
    settled(bound, loop)
    check_bound_as_by_core(bound, arm_rig())


def test_going_back_to_a_character_brings_its_edits(session, loop):
    session.state.resolution = 16
    loading.arrive(session, "?rig=robot&resolution=16")
    loop.run_until(lambda: session.state.binding is not None and not session.work.busy)
    correct.correct_joint(session, 3, deform=False)
    loop.rest(session)
    robot = session.state.edits
    loading.load_demo(session, "robot")
    loop.rest(session)
    assert not session.state.edits
    keys.act(session, "undo")
    loop.rest(session)
    assert session.state.edits == robot
    assert not session.state.rig.skeleton.deform[3]


def test_the_tree_and_what_stands_below_it(bound, loop):
    section = draw(bound, JOINTS)
    (tree,) = section.select(JointTree)
    loop.rest(bound)
    assert [(row["name"], row["level"]) for row in tree.rows] == [
        ("shoulder", 0), ("elbow", 1), ("wrist", 2),
    ]  # fmt: skip
    assert sum(row["ours"] for row in tree.rows) == pytest.approx(1)
    assert sum(row["file"] for row in tree.rows) == pytest.approx(1)
    assert len({row["color"] for row in tree.rows}) == 3
    tree._handle_msg({"type": "pick", "joint": 2})
    assert bound.state.joint == tree.chosen == 2
    carries, locked, *_ = section.select(pmui.Switch)
    carries.value = False
    loop.rest(bound)
    assert not tree.rows[2]["carries"]
    tree._handle_msg({"type": "carry", "joint": 2, "on": True})
    assert carries.value
    locked.value = True
    (gain,) = section.select(pmui.FloatSlider)
    gain.value = 1.0
    _, radius, *_ = section.select(pmui.TextInput)
    radius.value = "0.25"
    reach = Layer(Computed(gain={"wrist": 2.0}, radius={"wrist": 0.25}), name="Reach of joints")
    expected = Edits(layers=[reach, Layer(Locked(["wrist"]))])
    assert bound.state.edits == expected
    settled(bound, loop)
    check_bound_as_by_core(bound, arm_rig())
    bound.state.joint = 0
    assert (locked.value, gain.value, radius.value) == (False, 0.0, "")
    assert bound.state.edits == expected
    bound.state.joint = 2
    radius.value = "wide"
    assert "Radius must be a number" in bound.state.message[1]
    assert radius.value == "0.25"
    next(b for b in section.select(pmui.Button) if b.label == "Reset").clicks += 1
    assert not bound.state.edits
    put(bound.state, edits=ALL)
    assert gain.value == 0.0


def test_doubtful_joints_of_a_character_without_weights_are_marked_with_a_reason():
    rig = arm_rig()
    skeleton = replace(rig.skeleton, names=("shoulder", "IK", "wrist"))
    guess = deform_joints(rig.mesh, skeleton)
    rows = {}
    for weights in (None, rig.weights):
        state = SimpleNamespace(
            rig=replace(rig, skeleton=skeleton, weights=weights),
            binding=None,
            edits=Edits(),
            memo=Memo(),
        )
        rows[weights is None] = joint_rows(state, guess)
    assert [row["doubtful"] for row in rows[True]] == [False, True, False]
    assert rows[True][1]["why"] == "control or bone, by its name"
    assert not any(row["doubtful"] for row in rows[False])


def test_a_guess_that_arrives_after_another_character_was_opened_is_dropped(
    bound, loop, monkeypatch
):
    waiting = []
    monkeypatch.setattr(correct, "guess", lambda session, done: waiting.append(done))
    section = draw(bound, JOINTS)
    (tree,) = section.select(JointTree)
    arm = bound.state.rig
    late = deform_joints(arm.mesh, arm.skeleton)
    detect = next(b for b in section.select(pmui.Button) if b.label == "Detect deforming joints")
    detect.clicks += 1
    loading.load_demo(bound, "robot")
    loop.run_until(lambda: len(waiting) == 3 and not bound.work.busy)
    of_the_arm, by_the_button, _ = waiting
    of_the_arm(late)
    by_the_button(late)
    assert len(tree.rows) == len(bound.state.rig.skeleton.joints)
    assert not bound.state.edits


def test_a_vertex_is_overruled_with_all_that_lie_in_its_place(bound, loop):
    node = bound.state.binding.graph.vertex_node
    together = np.flatnonzero(node == node[7])
    computed = bound.state.binding.weights[7]
    correct.overrule(bound, 7, {0: 1.0, 2: 3.0, 1: 0.0})
    assert np.array_equal(bound.state.binding.weights[together], [[0.25, 0, 0.75]] * len(together))
    look.pick_vertex(bound, 7)
    bound.state.explain = True
    facts = vertex_facts(bound.state)
    assert facts["overruled"]
    assert [bone["weight"] for bone in facts["offered"]][:3] == [0.75, 0.25, 0]
    settled(bound, loop)
    reports = vertex_facts(bound.state)["why"]
    assert reports[0]["steps"][-1] == ["Painted", 0.75]
    correct.overrule(bound, 7, {0: 0.0})
    assert "needs a weight above 0" in bound.state.message[1]
    correct.overrule(bound, 7, None)
    assert not bound.state.edits
    np.testing.assert_allclose(bound.state.binding.weights[7], computed)


def test_parts_are_glued_and_seen_apart(session, loop):
    rig = arm_rig()
    button = trimesh.creation.icosphere(subdivisions=1, radius=0.1)
    first = len(rig.mesh.vertices)
    vertices = np.concatenate([rig.mesh.vertices, button.vertices + np.array([-1, 0, 0.38])])
    faces = np.concatenate([rig.mesh.faces, button.faces + first])
    session.state.resolution = 16
    loading.show_rig(session, cutcell.Rig(TriangleMesh(vertices, faces), rig.skeleton))
    section = draw(session, COMPONENTS)
    loop.rest(session)
    (rows,) = section.select(Rows)
    way, glue = section.select(pmui.Select)
    assert [row[0] for row in rows.rows] == [
        f"Part 1 · {first}",
        f"Part 2 · {len(vertices) - first}",
    ]
    rows._handle_msg({"type": "pick-row", "name": rows.rows[0][0]})
    loop.rest(session)
    assert "attached" not in way.options.values(), "the body cannot follow itself"
    rows._handle_msg({"type": "pick-row", "name": rows.rows[1][0]})
    loop.rest(session)
    assert "attached" in way.options.values()
    assert (rows.chosen, session.state.part, way.value) == (1, first, "")
    scene = resolve(session.state)
    assert len(scene.actors["part"].cells) == len(button.faces)
    assert scene.actors["body"].opacity < 0.5
    way.value = "filled"
    loop.rest(session)
    assert glue.value == "shoulder"
    glue.value = "wrist"
    loop.rest(session)
    assert (session.state.binding.weights[first:, 2] == 1).all()
    assert rows.rows[1][1] == "rigid: wrist"
    way.value = "computed"
    loop.rest(session)
    layer = Layer(Computed(as_skin=True), Mask(part=first))
    assert session.state.edits == Edits(layers=[layer])
    fresh = cutcell.bind(session.state.rig, 16, edits=session.state.edits)
    np.testing.assert_allclose(session.state.binding.weights, fresh.weights, atol=1e-9)
    way.value = ""
    assert not session.state.edits
    rows._handle_msg({"type": "pick-row", "name": rows.rows[1][0]})
    assert session.state.part is None


def test_a_step_of_the_lesson_shows_what_it_speaks_of_uncorrected(session, loop):
    session.state.resolution = 16
    loading.load_demo(session, session.state.lesson[1].demo)
    loop.run_until(lambda: session.state.binding is not None and not session.work.busy)
    correct.correct_joint(session, 3, deform=False)
    lesson.go(session, 1)
    loop.rest(session)
    assert not session.state.edits
    assert session.state.rig.skeleton.deform[3]


def test_tools_are_put_down_for_another_character(bound):
    bound.state.param.update(brush=True, joint_handle=True)
    loading.show_rig(bound, arm_rig())
    assert not bound.state.brush
    assert not bound.state.joint_handle


def test_a_coordinate_that_is_rounding_noise_is_shown_as_zero(bound):
    section = draw(bound, JOINTS)
    joint = bound.state.rig.skeleton.joints[2].tolist()
    bound.state.joint = 2
    moving.put(bound, [3.55e-15, *joint[1:]])
    (x,) = (field for field in section.select(pmui.TextInput) if field.label == "X")
    assert x.value == "0"


def test_controls_are_reset_before_the_error_is_shown(bound):
    """Who reads the error may enter something else, which a late reset would take away."""
    changes = []
    bound.state.param.watch(lambda event: changes.append(event.name), "message")
    bound.state.param.watch(lambda event: changes.append(event.name), "edits", onlychanged=False)
    first, second, *_ = bound.state.rig.skeleton.names
    correct.rename(bound, bound.state.rig.skeleton.names.index(second), first)
    assert changes == ["edits", "message"]
