"""The panel Check without a browser: findings, where they are, repairs, captions."""

import pickle
from dataclasses import replace

import numpy as np
import panel_material_ui as pmui
import pytest
from scipy.sparse import csr_array

import cutcell
from cutcell import Edits, Filled, JointEdit, Layer, Locked, Mask
from cutcell.diagnosis import Diagnosis, Finding
from cutcell.diagnosis.repair import WEIGHT_REPAIRS
from cutcell.errors import LocatedWarning
from cutcell.rig import TriangleMesh
from cutcell_app.document import loading
from cutcell_app.document.framing import bounds_of
from cutcell_app.editing.binding.recovery import is_current
from cutcell_app.editing.correct.commands import choose_file, correct, uses_file
from cutcell_app.features.check.choices import EXPORT
from cutcell_app.features.check.controls import CONTROLS, summary
from cutcell_app.features.check.results import look_at, repair, take_back
from cutcell_app.features.scenes import resolve
from cutcell_app.features.state import PageState
from cutcell_app.shell.character import faults
from cutcell_app.shell.export_controls import changes_of
from cutcell_app.shell.session import keys
from cutcell_app.shell.session.export import export_bound
from cutcell_app.widgets.controls import draw
from cutcell_app.widgets.rows import Rows
from cutcell_viewers.camera import sees
from cutcell_viewers.finding_scene import finding_marks
from cutcell_viewers.weights_scene import weight_colors
from tests.app.loop import settled
from tests.app.test_bare import bare_arm
from tests.cutcell.diagnosis.worm import worm
from tests.viewers.arm import arm_rig

FLIPPED = np.arange(0, 60)


def spoiled_arm():
    """Turn some faces, and let some vertices follow nothing."""
    rig = arm_rig()
    faces = rig.mesh.faces.copy()
    faces[FLIPPED] = faces[FLIPPED, ::-1]
    weights = rig.weights.copy()
    weights[:3] = 0
    return replace(rig, mesh=TriangleMesh(rig.mesh.vertices, faces), weights=weights)


@pytest.fixture
def spoiled(session, loop):
    """Let the session show the spoiled arm, diagnosed, on the panel."""
    session.state.param.update(resolution=16, panel="check")
    loading.show_rig(session, spoiled_arm())
    loop.run_until(lambda: session.state.diagnosis is not None)
    return session


def codes(session):
    return [finding.code for finding in session.state.diagnosis.findings]


def texts(session):
    """Return all that the panel says."""
    return texts_of(session, CONTROLS)


def texts_of(session, controls):
    """Return all that some controls say."""
    result, todo = [], [draw(session, controls)]
    while todo:
        one = todo.pop()
        todo += list(getattr(one, "objects", []))
        result += [text for text in (getattr(one, "object", None), getattr(one, "label", None))
                  if isinstance(text, str)]  # fmt: skip
    return "\n".join(result)


def test_what_is_bound_is_diagnosed(spoiled):
    assert codes(spoiled) == ["unweighted-vertices", "inverted-faces"]
    assert summary(spoiled.state) == "1 error, 1 warning. Choose one to see it."
    assert "Vertices without weight" in texts(spoiled)
    assert "Repair all 2 findings" in texts(spoiled)
    assert faults(spoiled.state) == [f.message for f in spoiled.state.diagnosis.findings]


def test_warnings_lead_to_the_findings_that_show_their_elements(bound, loop):
    rig = bound.state.rig
    warning = LocatedWarning("3 faces are wrong", "inverted-faces")
    bound.state.rig = replace(rig, warnings=("no joint is called so", warning))
    links = bound.state.warnings[:2]
    assert [link.code for link in links] == ["", "inverted-faces"]
    assert [link.label for link in links] == ["", "Show: inverted faces"]
    turned = replace(rig.mesh, faces=rig.mesh.faces[:, ::-1])
    codes = {warning.code for warning in cutcell.bind(replace(rig, mesh=turned), 16).warnings}
    assert "inverted-faces" in codes
    assert pickle.loads(pickle.dumps(warning)).code == warning.code


def test_a_warning_about_new_weights_leads_to_them_and_not_to_those_of_the_file(bound, loop):
    warning = LocatedWarning("it stretches", "stretched-surface")
    vertices, joints = bound.state.binding.weights.shape
    weights = np.eye(joints)[np.arange(vertices) % joints]
    bound.state.binding = replace(bound.state.binding, rows=csr_array(weights))
    bound.state.binding_warnings = (warning,)
    link = bound.state.warnings[-1]
    assert link.label == "Show: surface that stretches"
    bound.state.param.update(panel="check", finding=link.code)
    bound.engine.update()
    loop.run_until(lambda: bound.state.selected_finding is not None)
    assert bound.state.selected_finding is bound.state.export_diagnosis["stretched-surface"]


def test_a_sound_character_is_said_to_be_sound(bound, loop):
    loop.run_until(lambda: bound.state.diagnosis is not None)
    assert summary(bound.state).startswith("No problems")
    assert faults(bound.state) == []


def test_a_finding_is_marked_and_gone_to(spoiled):
    before = resolve(spoiled.state)
    assert not any(name.startswith("finding") for name in before.actors)
    look_at(spoiled, "inverted-faces")
    seen = resolve(spoiled.state)
    marked = seen.actors["finding faces"]
    assert len(marked.cells) == len(FLIPPED)
    assert seen.actors["body"].opacity < 1
    assert seen.legend.swatches[0][1] == "60 faces"
    assert "Binding already treats them as flipped" in texts(spoiled)
    assert sees(spoiled.view.camera, marked.points, spoiled.view.aspect)
    look_at(spoiled, "inverted-faces")
    assert spoiled.state.selected_finding is None


def test_a_repair_is_bound_and_can_be_taken_back(spoiled, loop):
    state, original = spoiled.state, spoiled.state.rig
    look_at(spoiled, "inverted-faces")
    repair(spoiled, ["inverted-faces"])
    loop.run_until(lambda: state.repair is not None and state.diagnosis is not None)
    assert codes(spoiled) == ["unweighted-vertices"]
    assert state.binding is not None
    repair(spoiled, ["unweighted-vertices"])
    loop.run_until(lambda: state.diagnosis is not None and not state.diagnosis.findings)
    assert len(state.repair.done) == 2
    assert "Repaired: 1 error, 1 warning → nothing" in texts(spoiled).replace("&#44;", ",")
    take_back(spoiled)
    loop.run_until(lambda: state.diagnosis is not None)
    assert state.rig is original
    assert state.repair is None
    assert len(codes(spoiled)) == 2


def test_what_was_repaired_is_exported(spoiled, loop, tmp_path):
    offered, state = [], spoiled.state
    repair(spoiled, ["inverted-faces", "unweighted-vertices"])
    loop.run_until(lambda: state.repair is not None)
    export_bound(spoiled, lambda *args: offered.append(args))
    loop.run_until(lambda: offered)
    name, content = offered[0]
    assert name == "arm-bound.glb"
    (tmp_path / name).write_bytes(content)
    again = cutcell.load(tmp_path / name)
    assert cutcell.diagnose(again, 16).findings == ()
    changed = np.abs(again.weights - spoiled_arm().weights).max(axis=1) > 1e-6
    assert np.flatnonzero(changed).tolist() == [0, 1, 2]
    assert uses_file(spoiled.state)
    assert changes_of(state) == "3 vertices differ from the file: Repaired 3."
    choose_file(spoiled, False)
    loop.run_until(lambda: is_current(spoiled))
    assert "Computed" in changes_of(state)


def test_another_character_begins_anew(spoiled, loop):
    look_at(spoiled, "inverted-faces")
    loading.show_rig(spoiled, bare_arm())
    assert (spoiled.state.diagnosis, spoiled.state.finding) == (None, "")
    loop.run_until(lambda: spoiled.state.diagnosis is not None)
    assert codes(spoiled) == []


def test_joints_and_vertices_get_beads():
    rig = arm_rig()
    weights = rig.weights.copy()
    weights[4] = 0
    result = cutcell.diagnose(replace(rig, weights=weights), 16)["unweighted-vertices"]
    marks = finding_marks(rig, replace(result, joints=np.array([1])))
    assert set(marks) == {"finding vertices", "finding joints"}
    for mark in marks.values():
        middle = mark.points.mean(axis=0)
        low, high = bounds_of(PageState(rig=rig))
        assert (middle >= low - 0.1).all()
        assert (middle <= high + 0.1).all()


def test_the_weights_of_the_export_are_checked(spoiled, loop):
    state = spoiled.state
    loop.run_until(lambda: state.export_diagnosis is not None)
    assert state.export_diagnosis.findings == ()
    assert codes(spoiled) == ["unweighted-vertices", "inverted-faces"]
    weights = state.binding.weights.copy()
    weights[:5] = 0
    state.binding = replace(state.binding, rows=csr_array(weights))
    spoiled.engine.update()
    loop.run_until(lambda: state.export_diagnosis.findings)
    look_at(spoiled, EXPORT + "unweighted-vertices")
    assert state.selected_finding.vertices.tolist() == list(range(5))
    look_at(spoiled, "unweighted-vertices")
    assert state.selected_finding.vertices.tolist() == list(range(3))


def test_joints_that_lead_a_part_are_locked_not_excluded(bound, loop):
    loop.run_until(lambda: bound.state.diagnosis is not None)
    rig = bound.state.rig
    eye, control = 2, 1
    weights = rig.weights.copy()
    weights[:, control] = np.minimum(weights[:, control], 0.2)
    weights[:, eye] = 0
    weights[:2, [eye, control]] = [1, 0]
    weights[:, 0] = 1 - weights[:, 1:].sum(axis=1)
    bound.state.rig = rig.with_weights(weights)
    finding = Finding("stray-weights", "warning", "", "", joints=np.array([control, eye]))
    bound.state.param.update(diagnosis=Diagnosis(rig, (finding,)), finding=finding.code)
    buttons = {button.label: button for button in draw(bound, CONTROLS).select(pmui.Button)}
    next(b for label, b in buttons.items() if "Exclude elbow" in label)
    next(b for label, b in buttons.items() if "Lock wrist" in label).clicks += 1
    assert bound.state.edits == Edits(layers=[Layer(Locked(["wrist"]))])


def labels(session):
    return {button.label: button for button in draw(session, CONTROLS).select(pmui.Button)}


def test_a_repair_in_vain_is_said_and_not_offered_again(spoiled, loop, monkeypatch):
    state, before = spoiled.state, spoiled.state.rig
    look_at(spoiled, "unweighted-vertices")
    assert {"Repair", "Repair all 2 findings"} <= labels(spoiled).keys()
    monkeypatch.setitem(
        WEIGHT_REPAIRS, "unweighted-vertices", lambda rig, weights, vertices: weights
    )
    repair(spoiled, ["unweighted-vertices"])
    loop.run_until(lambda: state.repair is not None)
    assert state.rig is before
    assert state.repair.in_vain == {"unweighted-vertices"}
    look_at(spoiled, "unweighted-vertices")
    look_at(spoiled, "unweighted-vertices")
    assert not {"Repair", "Repair all 2 findings", "Undo repair"} & labels(spoiled).keys()
    repair(spoiled, ["inverted-faces"])
    loop.run_until(lambda: state.rig is not before and state.diagnosis is not None)
    assert codes(spoiled) == ["unweighted-vertices"]
    assert "Undo repair" in labels(spoiled)


def test_the_files_weights_are_not_offered_where_they_are(bound, loop):
    state = bound.state
    weights = state.rig.weights.copy()
    weights[:5] = np.roll(weights[:5], 1, axis=1)
    state.rig = state.rig.with_weights(weights)
    finding = Finding("weight-islands", "warning", "", "", vertices=np.arange(5))
    shown = {"export_diagnosis": Diagnosis(state.rig, (finding,)), "panel": "check"}
    state.param.update(**shown, finding=EXPORT + finding.code)
    assert "Take from file here" in labels(bound)
    state.binding = replace(state.binding, rows=csr_array(weights))
    state.param.update(**shown, finding=EXPORT + finding.code)
    assert "Take from file here" not in labels(bound)


def far_part(bound, loop):
    """Let a finding name the whole arm as a part; return the list of what it may follow."""
    state = bound.state
    loop.run_until(lambda: state.diagnosis is not None)
    finding = Finding("far-parts", "warning", "A part is far.", "", vertices=np.arange(5),
                      details=("Part 2 (5 vertices) follows shoulder; wrist is nearest",),
                      parts=((0, 2),), empty=(1,))  # fmt: skip
    state.param.update(
        panel="check", diagnosis=Diagnosis(state.rig, (finding,)), finding=finding.code
    )
    (rows,) = draw(bound, CONTROLS).select(Rows)
    return rows


def test_a_part_may_follow_what_it_touches_or_an_empty_or_the_nearest_joint(bound, loop):
    rows = far_part(bound, loop)
    assert [name for name, *_ in rows.rows] == [
        "Part 2: with the body it touches", "Part 2: rigid to elbow, empty so far",
        "Part 2: rigid to wrist", "Part 2: keep as in the file",
    ]  # fmt: skip
    rows.click(2)
    (layer,) = bound.state.edits.layers
    assert layer == Layer(Filled({"wrist": 1.0}), Mask(part=0))
    (rows,) = draw(bound, CONTROLS).select(Rows)
    assert rows.chosen == 2


def test_what_a_part_would_follow_is_seen_under_the_pointer(bound, loop):
    rows, state = far_part(bound, loop), bound.state
    before = resolve(state)
    rows._handle_msg({"type": "point-at-row", "name": rows.rows[2][0]})
    assert not state.edits.layers
    colors = resolve(state).actors["body"].colors
    wrist = weight_colors(state.rig, np.tile([0.0, 0.0, 1.0], (len(colors), 1)))[0]["colors"]
    np.testing.assert_array_equal(colors, wrist)
    rows._handle_msg({"type": "point-at-row", "name": None})
    assert resolve(state).actors.keys() == before.actors.keys()
    rows._handle_msg({"type": "point-at-row", "name": rows.rows[0][0]})
    rows.click(2)
    assert state.tried is None


def test_a_kept_part_is_a_warning_no_more_wherever_the_edits_go(bound, loop):
    rows, state = far_part(bound, loop), bound.state
    assert faults(state)
    rows.click(3)
    assert not faults(state)
    assert not state.open_findings
    assert "Done" in texts(bound)
    state.edits = Edits.from_json(state.edits.to_json())
    assert not state.open_findings
    state.edits = Edits()
    assert faults(state)


def test_a_joint_that_a_part_is_made_rigid_to_carries_weight_then(bound, loop):
    state = bound.state
    correct(bound, Edits(joints={"elbow": JointEdit(deform=False)}))
    settled(bound, loop)
    far_part(bound, loop).click(1)
    assert state.rig.skeleton.deform.all()


def test_exchanged_joints_are_mended_by_a_layer_over_the_files_weights(session, loop):
    sound = worm()
    session.state.param.update(resolution=16, panel="check")
    loading.show_rig(session, sound.with_weights(sound.weights[:, [0, 1, 5, 3, 4, 2, 6]]))
    state = session.state
    loop.run_until(lambda: state.diagnosis is not None)
    look_at(session, "exchanged-joints")
    labels(session)["Exchange these weights"].clicks += 1
    settled(session, loop)
    np.testing.assert_array_equal(state.weights, sound.weights)
    assert state.layer == 0
    assert "exchanged-joints" not in [one.code for one in state.open_findings]
    keys.act(session, "undo")
    loop.rest(session)
    assert state.edits == Edits()
    assert "exchanged-joints" in [one.code for one in state.open_findings]
