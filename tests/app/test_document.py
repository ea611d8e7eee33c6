"""A character is opened and repaired whole or not at all; no work is lost on the way."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import FromFile
from cutcell.rig import TriangleMesh
from cutcell_app.document import loading, opening
from cutcell_app.document.document import applied
from cutcell_app.document.recording import present, query
from cutcell_app.editing.binding import recovery
from cutcell_app.editing.correct import moving, templates
from cutcell_app.editing.layers import commands as layers
from cutcell_app.features.check.results import repair
from cutcell_app.features.learn import steps
from cutcell_app.shell.export_code import recipe_of
from cutcell_app.shell.session import export, keys
from tests.app.test_bare import bare_arm
from tests.viewers.arm import arm_rig

MOMENTARY = {"busy", "stage", "fraction", "exporting", "message"}
ASIDE = np.array([0.05, 0, 0])


def faulty_arm():
    """Return an arm with a face twice, and a face without area."""
    rig = arm_rig()
    faces = np.vstack([rig.mesh.faces, rig.mesh.faces[:1], [[0, 0, 1]]])
    return replace(rig, mesh=TriangleMesh(rig.mesh.vertices, faces))


def everything(session):
    """Return all that opening a character changes."""
    values = {n: v for n, v in session.state.param.values().items() if n not in MOMENTARY}
    documents = session.history._documents, session.history._place
    now = session.history.now
    return values, query(session), documents, now, session.source, session.uploads.key


def same(one, other):
    """Whether two snapshots hold the same; large values are the same objects."""
    (values, *rest), (others, *remaining) = one, other
    differ = [
        n for n in values if values[n] is not others[n] and not np.all(values[n] == others[n])
    ]
    return differ == [] and rest == remaining


@pytest.fixture(autouse=True)
def demos(monkeypatch):
    """Let all demos be arms."""
    arms = {}
    monkeypatch.setattr(opening, "demo_rig", lambda id: arms.setdefault(id, arm_rig()))


@pytest.fixture
def edited(session, loop):
    """Show a demo with a layer and a moved joint."""
    session.state.param.update(resolution=12, graph_resolution=0)
    loading.load_demo(session, "robot")
    loop.rest(session)
    layers.put_content(session, np.arange(5), FromFile)
    move(session, 1)
    loop.rest(session)
    return session


def move(session, joint):
    session.state.joint = joint
    moving.put(session, session.state.rig.skeleton.joints[joint] + ASIDE)


def visit(session, address):
    session.view._handle_msg({"type": "visit", "query": address})


OPENINGS = {
    "demo": lambda session: loading.load_demo(session, "rabbit"),
    "back": lambda session: visit(session, "?rig=rabbit&resolution=20&panel=graph&step=2"),
    "step": lambda session: steps.go(session, 0),
    "undo": lambda session: keys.act(session, "undo"),
    "redo": lambda session: keys.act(session, "redo"),
}


@pytest.mark.parametrize("way", OPENINGS)
def test_cancel_leaves_everything_as_it_was(edited, loop, way):
    session = edited
    if way in ("undo", "redo"):
        loading.load_demo(session, "rabbit")
        loop.rest(session)
        if way == "redo":
            keys.act(session, "undo")
            loop.rest(session)
    before = everything(session)
    OPENINGS[way](session)
    assert session.work.busy
    recovery.cancel(session)
    loop.rest(session)
    assert same(everything(session), before)
    assert session.state.message == ("info", "Cancelled. Nothing was changed.")
    recipe = recipe_of(session)
    assert (recipe.demo, recipe.rig) == (session.state.demo, session.state.rig)
    loads = session.work.running()
    session.history.part()
    session.state.skeleton = False
    keys.act(session, "undo")
    assert session.state.skeleton
    assert session.work.running() == loads, "undo of a switch opens no file"


@pytest.mark.parametrize("address", ["?rig=~gone&bone=head&panel=graph", "?rig=nobody&step=3"])
def test_an_address_that_cannot_be_opened_changes_nothing(edited, loop, address):
    before = everything(edited)
    visit(edited, address)
    loop.rest(edited)
    assert same(everything(edited), before)
    assert edited.state.message[0] == "error"
    loading.load_demo(edited, "rabbit")
    loop.rest(edited)  # of the dead link nothing is left
    assert (edited.state.step, edited.view.at_home) == (-1, True), (
        "of the dead link nothing is left"
    )


def test_a_bad_file_changes_nothing(edited, loop, tmp_path):
    path = tmp_path / "bad.glb"
    path.write_text("no character")
    before, paths = everything(edited), edited.paths
    loading.load_files(edited, [path])
    loop.rest(edited)
    assert same(everything(edited), before)
    assert edited.paths is paths


def test_edits_made_while_a_repair_runs_are_on_the_page_and_in_the_file(session, loop, tmp_path):
    session.state.param.update(resolution=12, graph_resolution=0)
    loading.show_rig(session, faulty_arm())
    loop.rest(session)
    state, got = session.state, {}
    repair(session, ["duplicate-faces"])
    move(session, 1)
    place = state.rig.skeleton.joints[1].copy()
    loop.rest(session)
    assert state.repair.codes == (("duplicate-faces",),)
    np.testing.assert_array_equal(state.rig.skeleton.joints[1], place)
    np.testing.assert_array_equal(applied(state.own, None, state.edits).skeleton.joints[1], place)
    export.export_bound(session, lambda *file: got.update([file]))
    loop.run_until(lambda: bool(got))
    path = tmp_path / "arm.glb"
    path.write_bytes(got["arm-bound.glb"])
    exported = cutcell.load(path)
    assert len(exported.mesh.faces) == len(faulty_arm().mesh.faces) - 1
    np.testing.assert_allclose(exported.skeleton.joints[1], place, atol=1e-5)


def test_a_second_repair_waits_for_the_first(session, loop):
    session.state.param.update(resolution=12, graph_resolution=0)
    loading.show_rig(session, faulty_arm())
    loop.rest(session)
    repair(session, ["duplicate-faces"])
    repair(session, ["degenerate-faces"])
    assert session.state.stage.endswith("then a repair")
    loop.rest(session)
    assert session.state.repair.codes == (("duplicate-faces",), ("degenerate-faces",))
    assert len(session.state.rig.mesh.faces) == len(arm_rig().mesh.faces)
    for faces in (1, 2, 1, 0):
        keys.act(
            session, "undo" if faces and not (faces == 1 and session.history.can_redo) else "redo"
        )


def test_a_template_that_is_fitted_and_a_character_that_is_opened_wait(bare, loop):
    bare.source = "demo robot"
    templates.fit(bare, "chain")
    keys.act(bare, "undo")
    loading.load_demo(bare, "rabbit")
    loop.rest(bare)
    assert bare.state.demo == "rabbit"
    assert bare.state.message is None


def test_undo_across_characters_brings_edits_and_repairs_and_keeps_redo(session, loop, tmp_path):
    path = tmp_path / "faulty.glb"
    cutcell.save(path, faulty_arm())
    session.state.param.update(resolution=12, graph_resolution=0)
    loading.load_files(session, [path])
    loop.rest(session)
    state, past = session.state, []
    codes = [one.code for one in state.diagnosis.findings if one.repair]
    assert codes
    repair(session, codes)
    loop.rest(session)
    move(session, 1)
    layers.put_content(session, np.arange(5), FromFile)
    loop.rest(session)
    past.append(present(session))
    weights = state.binding.weights
    loading.load_demo(session, "robot")
    loop.rest(session)
    session.history.part()
    move(session, 2)
    loop.rest(session)
    past.append(present(session))
    for _ in range(20):
        if session.source == "~":
            break
        keys.act(session, "undo")
        loop.rest(session)
    assert present(session).differences(past[0]) == set()
    assert len(state.rig.mesh.faces) == len(past[0].rig.mesh.faces)
    np.testing.assert_allclose(state.binding.weights, weights, atol=1e-9)
    assert session.view.last_sent("able") == [True, True]
    while session.history.can_redo:
        keys.act(session, "redo")
        loop.rest(session)
    assert present(session).differences(past[1]) == set()


def test_two_undos_at_once_across_characters_are_two(edited, loop):
    loading.load_demo(edited, "rabbit")
    loop.rest(edited)
    steps_before = len(edited.history)
    keys.act(edited, "undo")
    keys.act(edited, "undo")
    loop.rest(edited)
    assert edited.state.demo == "robot"
    assert len(edited.history) == steps_before - 2


def test_an_address_brings_repairs_back(session, loop):
    session.state.param.update(resolution=12, graph_resolution=0)
    loading.show_rig(session, faulty_arm(), "demo robot")
    loop.rest(session)
    repair(session, ["duplicate-faces"])
    loop.rest(session)
    faces, address = len(session.state.rig.mesh.faces), query(session)
    assert "repairs=duplicate-faces" in address
    loading.show_rig(session, faulty_arm(), "demo robot")
    visit(session, "?resolution=12&repairs=nothing")
    assert "repairs=nothing" in session.state.message[1]
    visit(session, f"?{address}")
    loop.rest(session)
    assert len(session.state.rig.mesh.faces) == faces
    assert session.state.repair.codes == (("duplicate-faces",),)


def test_a_lesson_that_is_left_while_its_first_step_opens_is_left(edited, loop):
    before = everything(edited)
    steps.go(edited, 0)
    steps.go(edited, -1)
    loop.rest(edited)
    assert same(everything(edited), before)


def test_a_hidden_option_stays_when_another_is_cancelled(bound, loop):
    bound.state.alpha = 0.3
    loop.rest(bound)
    bound.state.resolution = 20
    recovery.cancel(bound)
    assert (bound.state.alpha, bound.state.resolution) == (0.3, 16)


def test_a_layer_that_undo_has_removed_is_not_changed(bound, loop):
    layers.put_content(bound, np.arange(5), FromFile)
    layers.put_content(bound, np.arange(5, 9), FromFile)
    keys.act(bound, "undo")
    assert bound.state.layer is None
    layers.set_layer(bound, 1, name="x")
    assert len(bound.state.edits.layers) == 1
    assert bare_arm().mesh is not None
