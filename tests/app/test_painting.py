"""The brush on the page: strokes become weights of vertices, and nothing else."""

import numpy as np
import panel_material_ui as pmui
import pytest

from cutcell import Edits, Layer, Locked, Mask
from cutcell_app.document import loading
from cutcell_app.document.address import from_query
from cutcell_app.document.selection import selected
from cutcell_app.editing.brush import controls as brush_controls
from cutcell_app.editing.brush import strokes as brush
from cutcell_app.editing.brush.choices import MIN_RADIUS, MIN_STRENGTH
from cutcell_app.editing.brush.strokes import radius_of
from cutcell_app.editing.compute.brush import paint_weights
from cutcell_app.editing.compute.stack import painted_vertices
from cutcell_app.editing.compute.stroke import Brush, PaintSurface, Stroke
from cutcell_app.editing.correct import commands as correct
from cutcell_app.editing.layers.commands import STEPS, in_steps
from cutcell_app.editing.select.controls import SELECTION
from cutcell_app.features.pose import results as pose
from cutcell_app.features.scenes import resolve
from cutcell_app.files.edits_file import MAX_IN_ADDRESS, MAX_VERTICES, to_text, vertices_named
from cutcell_app.looks.weights import painted_colors
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import draw
from tests.app.loop import check_bound_as_by_core, settled
from tests.viewers.arm import arm_rig

MIDDLE = 30


@pytest.fixture
def painter(bound, loop, monkeypatch):
    """Take up the brush; what the browser is answered is kept."""
    answers = []
    monkeypatch.setattr(bound.view, "answer", lambda **message: answers.append(message))
    bound.answers = answers
    bound.state.joint = 2
    bound.state.param.update(brush=True, brush_radius=0.2, brush_mirrored=False)
    loop.rest(bound)
    return bound


def paint(session, **parts):
    """Send a part of a stroke."""
    session.view._handle_msg({"type": "paint", **parts})


def stroke(session, *vertices, **more):
    """Paint over some vertices as the browser does: in pieces."""
    for place, vertex in enumerate(vertices):
        point = [vertex, vertex, vertex, 1, 0, 0]
        last = place == len(vertices) - 1
        paint(session, points=point, first=place == 0, done=last, **more)


def test_a_stroke_goes_on_from_the_one_before_it_that_is_not_computed_yet(
    painter, loop, monkeypatch
):
    monkeypatch.setattr("cutcell_app.document.state.QUICK_MESH", 0)
    state = painter.state
    expected, made = state.binding.weights, Brush(radius_of(state), "add", state.brush_strength)
    rig, most = state.rig, state.max_influences
    for vertex in (MIDDLE, MIDDLE + 1):
        expected = paint_weights(rig, expected, 2, [vertex], made, max_influences=most)
    stroke(painter, MIDDLE)
    paint(painter, points=[MIDDLE + 1] * 3 + [1, 0, 0], first=True)
    before = state.binding
    loop.run_until(lambda: state.binding is not before)  # the first arrives during the second
    paint(painter, done=True)
    settled(painter, loop)
    assert {"gone": True} not in [answer.get("painted") for answer in painter.answers]
    np.testing.assert_allclose(state.binding.weights, expected, rtol=0, atol=2 / STEPS)


@pytest.mark.parametrize("mode", ["add", "subtract", "replace", "smooth"])
def test_pieces_of_a_stroke_add_up_to_it(painter, mode):
    state = painter.state
    brush = Brush(radius_of(state), mode, state.brush_strength, state.brush_value)
    made = Stroke(PaintSurface(state.rig.mesh), state.rig, state.binding.rows, 2, brush)
    pieces = state.binding.weights.copy()
    for vertex in (MIDDLE, MIDDLE + 1, MIDDLE + 40, MIDDLE):
        made.pass_over(np.array([[vertex]]), np.ones((1, 1)))
        which, rows = made.continued()
        pieces[which] = rows
    vertices, rows = made.painted()
    np.testing.assert_allclose(pieces[vertices], rows, rtol=0, atol=1e-12)
    assert mode == "smooth" or not len(which), "the last one passes over a point again"


@pytest.mark.parametrize("mode", ["add", "subtract", "replace", "smooth"])
def test_a_stroke_is_what_the_core_paints_and_one_step_to_undo(painter, loop, mode):
    state = painter.state
    state.brush_mode = mode
    before = state.binding.weights
    made = Brush(radius_of(state), mode, state.brush_strength, state.brush_value)
    expected = paint_weights(
        state.rig, before, 2, [MIDDLE, MIDDLE + 1], made, max_influences=state.max_influences
    )
    stroke(painter, MIDDLE, MIDDLE + 1)
    settled(painter, loop)
    after = state.binding.weights
    np.testing.assert_allclose(after, expected, rtol=0, atol=1 / STEPS)
    np.testing.assert_allclose(after.sum(axis=1), 1, rtol=0, atol=1e-12)
    changed = (np.abs(expected - before) > 1 / STEPS).any(axis=1)
    assert changed.any()
    others = np.delete(np.arange(len(after)), painted_vertices(state.edits))
    assert np.array_equal(after[others], before[others])
    check_bound_as_by_core(painter, arm_rig())
    keys.act(painter, "undo")
    settled(painter, loop)
    assert np.array_equal(state.binding.weights, before)
    assert not state.edits
    assert state.brush, "undo takes the stroke back, not the brush"
    keys.act(painter, "redo")
    settled(painter, loop)
    assert np.array_equal(state.binding.weights, after)


def test_the_brush_prepares_smoothing_before_the_first_stroke(painter, loop, monkeypatch):
    monkeypatch.setattr("cutcell_app.editing.compute.stroke.cotangent_laplacian", None)
    stroke(painter, MIDDLE, mode="smooth")
    settled(painter, loop)
    assert painter.state.edits


def test_strokes_that_follow_at_once_are_steps_of_their_own(painter, loop):
    state = painter.state
    held = [state.binding.weights]
    for vertex in (MIDDLE, MIDDLE + 7, 3):
        stroke(painter, vertex)
        settled(painter, loop)
        held.append(state.binding.weights)
        assert not np.array_equal(held[-1], held[-2])
    for before in held[-2::-1]:
        keys.act(painter, "undo")
        settled(painter, loop)
        assert np.array_equal(state.binding.weights, before)
    assert not state.edits


def test_colours_follow_each_piece_and_are_those_of_the_scene_after(painter, loop):
    state = painter.state
    first = resolve(state).actors["body"].scalars
    stroke(painter, MIDDLE, MIDDLE + 1, MIDDLE + 2)
    pieces = [answer["painted"] for answer in painter.answers]
    assert len(pieces) == 3
    sizes = [len(one["vertices"]) for one in pieces]
    assert 0 < sizes[0] <= sizes[1] <= sizes[2]
    settled(painter, loop)
    last = resolve(state).actors["body"].scalars
    seen = first.copy()
    seen[pieces[-1]["vertices"]] = pieces[-1]["scalars"]
    np.testing.assert_allclose(seen, last, rtol=0, atol=1 / STEPS)


@pytest.mark.parametrize("shown", ["mix", "dominant", "bone", "count", "difference",
                                   "bone_difference"])  # fmt: skip
def test_colours_of_a_few_vertices_are_those_of_the_whole(painter, shown):
    state = painter.state
    state.weights_shown = shown
    some = np.array([3, 20, 41])
    colors = painted_colors(state, some, state.weights[some])
    body = resolve(state).actors["body"]
    ((name, few),) = colors.items()
    assert np.array_equal(few, getattr(body, name)[some])
    state.weights_of = "file"
    assert painted_colors(state, some, state.weights[some]) == {}


def test_a_stroke_that_is_cancelled_or_changes_nothing_leaves_nothing(painter, loop):
    state = painter.state
    steps = painter.history.now
    paint(painter, points=[MIDDLE] * 3 + [1, 0, 0], first=True)
    paint(painter, cancelled=True)
    back = painter.answers[-1]["painted"]
    assert np.array_equal(back["scalars"], state.weights[back["vertices"], 2].astype(np.float32))
    paint(painter, points=[], done=True)
    assert painter.answers[-1] == {"painted": {"gone": True}}
    paint(painter, points=[10**6] * 3 + [1, 0, 0], first=True, done=True)
    assert not state.edits
    state.brush_mode = "replace"
    state.brush_value = 0.0
    away = int(state.weights[:, 2].argmin())
    assert state.weights[away, 2] == 0
    state.brush_radius = MIN_RADIUS
    stroke(painter, away)
    assert not state.edits
    assert painter.history.now is steps, "no step to undo"


def test_locked_and_idle_joints_are_told(painter, loop):
    state = painter.state
    correct.correct_joint(painter, 2, locked=True)
    settled(painter, loop)
    stroke(painter, MIDDLE)
    assert '"wrist" is locked' in state.message[1]
    assert painter.answers[-1] == {"painted": {"gone": True}}
    correct.correct_joint(painter, 2, locked=False, deform=False)
    loop.rest(painter)
    stroke(painter, MIDDLE)
    assert "carries no weight" in state.message[1]
    assert not len(painted_vertices(state.edits))
    correct.correct_joint(painter, 2, deform=True)
    correct.correct_joint(painter, 0, locked=True)
    state.message = None
    settled(painter, loop)
    before = state.weights
    stroke(painter, int((before[:, 1] * before[:, 2]).argmax()))
    settled(painter, loop)
    assert len(painted_vertices(state.edits))
    np.testing.assert_allclose(state.weights[:, 0], before[:, 0], rtol=0, atol=1 / STEPS)


def test_it_paints_while_the_character_is_posed(painter, loop):
    state = painter.state
    state.panel = "pose"
    pose.turn_joint(painter, 2, 40.0)
    assert painter.view.last_sent("gizmo") is None, "rings would be in the way"
    assert painter.view.last_sent("brush")["radius"] == pytest.approx(radius_of(state))
    stroke(painter, MIDDLE)
    settled(painter, loop)
    assert "scalars" in painter.answers[-1]["painted"]
    posed = state.binding.weights
    check_bound_as_by_core(painter, arm_rig())
    state.panel = "weights"
    keys.act(painter, "undo")
    keys.act(painter, "undo")
    settled(painter, loop)
    stroke(painter, MIDDLE)
    settled(painter, loop)
    assert np.array_equal(posed, state.binding.weights), "a stroke lies on the surface at rest"
    state.param.update(panel="pose", moving=True, playing=True)
    assert painter.view.last_sent("brush") is None
    state.playing = False
    assert painter.view.last_sent("brush") is not None
    state.panel = "graph"
    loop.rest(painter)
    assert painter.view.last_sent("brush") is None


def test_what_is_painted_stays_with_the_address_and_after_rebinding(painter, loop):
    state = painter.state
    state.brush_radius = 0.5
    for vertex in range(0, len(arm_rig().mesh.vertices), 75):
        stroke(painter, vertex)
        settled(painter, loop)
    held = state.edits
    assert vertices_named(held) > MAX_VERTICES
    assert len(to_text(held)) > MAX_IN_ADDRESS
    said = from_query(painter.view.last_sent("address"), state)[1]["edits"]
    assert len(said) < MAX_IN_ADDRESS
    loading.show_rig(painter, arm_rig(), edits=said)
    settled(painter, loop)
    assert state.edits == held
    check_bound_as_by_core(painter, arm_rig())
    assert Edits.from_json(held.to_json()) == held
    state.resolution = 20
    settled(painter, loop)
    check_bound_as_by_core(painter, arm_rig())
    (layer,) = held.layers
    columns = [state.rig.skeleton.names.index(name) for name in layer.content.joints]
    bound = state.binding.weights[layer.content.vertices]
    np.testing.assert_array_equal(bound[:, columns], layer.content.rows.toarray())
    np.testing.assert_allclose(bound[:, columns].sum(axis=1), 1)


def test_keys_and_switches(painter, loop):
    state = painter.state
    keys.act(painter, "brush larger")
    assert state.brush_radius == pytest.approx(0.25)
    for _ in range(40):
        keys.act(painter, "brush smaller")
        keys.act(painter, "brush weaker")
    assert (state.brush_radius, state.brush_strength) == (MIN_RADIUS, MIN_STRENGTH)
    for _ in range(20):
        keys.act(painter, "brush stronger")
    assert state.brush_strength == 1
    keys.act(painter, "brush away")
    assert not state.brush
    assert painter.view.last_sent("brush") is None
    state.panel = "graph"
    keys.act(painter, "brush")
    assert (state.panel, state.brush) == ("weights", True)
    keys.act(painter, "brush")
    state.param.update(weights_shown="mix", weights_of="file", joint_handle=True)
    keys.act(painter, "brush")
    assert (state.weights_shown, state.weights_of, state.joint_handle) == ("bone", "ours", False)
    state.joint_handle = True
    assert not state.brush
    assert not {"brush", "brush_radius"} & painter.history.now.choices.keys()


def test_the_section_says_what_is_painted(painter, loop):
    section = draw(painter, brush_controls.BRUSH)
    modes = section.select(pmui.RadioButtonGroup)[0]
    modes.value = "smooth"
    assert painter.state.brush_mode == "smooth"
    switch, mirrored = section.select(pmui.Switch)
    assert switch.value
    assert not mirrored.visible, "the arm has no other side"
    switch.value = False
    assert not painter.state.brush
    value = section.select(pmui.FloatSlider)[2]
    assert not value.visible
    painter.state.brush_mode = "replace"
    loop.rest(painter)
    assert value.visible


def test_whole_steps_sum_to_one():
    rng = np.random.default_rng(5)
    rows = (
        rng.random((200, 7)) * (rng.random((200, 7)) < 0.6) + np.eye(7)[rng.integers(7, size=200)]
    )
    rows /= rows.sum(axis=1, keepdims=True)
    steps = in_steps(rows)
    assert (steps.sum(axis=1) == STEPS).all()
    assert np.abs(steps - rows * STEPS).max() < 1
    assert not steps[rows == 0].any()
    exact = np.array([[0.25, 0.75, 0], [1, 0, 0], [0.1, 0.2, 0.7]])
    assert np.array_equal(in_steps(exact), np.round(exact * STEPS))


def test_the_other_side_is_painted_where_there_is_one(session, loop):
    session.state.resolution = 16
    loading.load_demo(session, "robot")
    loop.run_until(lambda: session.state.binding is not None and not session.work.busy)
    state = session.state
    names = state.rig.skeleton.names
    state.param.update(joint=names.index("forearm.L"), brush=True, brush_radius=0.05)
    assert session.view.last_sent("brush")["mirror"] is None
    state.brush_mirrored = True
    part = session.view.last_sent("brush")
    assert np.linalg.norm(part["mirror"][:3]) == pytest.approx(1)
    mesh, joint = state.rig.mesh, state.rig.skeleton.joints[state.joint]
    distance = np.linalg.norm(mesh.vertices - joint, axis=1)
    vertex = int(np.where(state.weights[:, state.joint] < 0.5, distance, np.inf).argmin())
    point = [vertex, vertex, vertex, 1, 0, 0]
    paint(session, points=point, first=True, done=True)
    loop.rest(session)
    x = state.rig.mesh.vertices[painted_vertices(state.edits), 0]
    assert (x > 0).any()
    assert (x < 0).any()
    assert state.edits.joints == {}
    state.panel = "pose"
    assert session.view.last_sent("brush") == part
    pose.turn_joint(session, 0, 20.0)
    assert session.view.last_sent("brush")["mirror"] is None, "its image is not where it paints"
    state.panel = "weights"
    assert session.view.last_sent("brush") == part
    state.brush_mirrored = False
    assert session.view.last_sent("brush")["mirror"] is None
    assert brush.paints(state)


def test_strokes_stay_on_what_is_selected(painter, loop):
    state = painter.state
    state.brush_mode = "select"
    stroke(painter, MIDDLE)
    settled(painter, loop)
    chosen = selected(state)
    assert 1 < chosen.sum() < len(chosen)
    assert chosen[MIDDLE]
    assert not state.edits
    assert len(resolve(state).actors["selection"].points) == chosen.sum()
    state.param.update(brush_mode="add", brush_radius=0.4)
    before = state.binding.weights
    stroke(painter, MIDDLE)
    settled(painter, loop)
    changed = (state.binding.weights != before).any(axis=1)
    assert changed.any()
    assert not (changed & ~chosen).any()
    assert np.array_equal(selected(state), chosen), "it outlives what is bound again"
    brush.invert_selection(painter)
    assert np.array_equal(selected(state), ~chosen)
    brush.clear_selection(painter)
    assert selected(state) is None
    assert "selection" not in resolve(state).actors


def test_ctrl_takes_away_from_the_selection_and_a_cancelled_stroke_leaves_it(painter, loop):
    state = painter.state
    state.brush_mode = "select"
    stroke(painter, MIDDLE)
    chosen = selected(state).copy()
    point = [MIDDLE + 8, MIDDLE + 8, MIDDLE + 8, 1, 0, 0]
    paint(painter, points=point, first=True)
    assert selected(state).sum() > chosen.sum()
    paint(painter, cancelled=True)
    assert np.array_equal(selected(state), chosen)
    stroke(painter, MIDDLE, mode="subtract")
    settled(painter, loop)
    assert selected(state) is None, "nothing selected limits nothing"


HALF = np.arange(0, 120, 2)
"""Vertices of which many are under the brush at `MIDDLE`."""


@pytest.mark.parametrize("mode", ["add", "replace", "smooth"])
@pytest.mark.parametrize("locked", [0, 2])
@pytest.mark.parametrize("opacity", [1, 0.5])
def test_a_stroke_shows_what_locks_of_some_vertices_leave(painter, loop, mode, locked, opacity):
    state = painter.state
    names, in_file = state.rig.skeleton.names, state.rig.weights
    lock = Layer(Locked([names[locked]]), Mask(vertices=HALF), opacity=opacity)
    correct.correct(painter, Edits(layers=[lock]))
    state.param.update(brush_mode=mode, brush_value=0.7)
    settled(painter, loop)
    before, count = state.weights, len(state.weights)
    stroke(painter, MIDDLE, MIDDLE + 1)
    last = painter.answers[-1]["painted"]
    settled(painter, loop)
    after = state.weights
    if opacity == 1:
        assert np.array_equal(after[HALF, locked], in_file[HALF, locked])
    np.testing.assert_allclose(after[HALF, locked], before[HALF, locked], atol=1 / STEPS)
    assert (after != before).any()
    np.testing.assert_allclose(after[last["vertices"], 2], last["scalars"], atol=2 / STEPS)
    others = np.setdiff1d(np.arange(count), last["vertices"])
    assert np.array_equal(after[others], before[others])
    check_bound_as_by_core(painter, arm_rig())


def test_a_stroke_where_the_bone_is_locked_says_so(painter, loop):
    state = painter.state
    state.brush_radius = MIN_RADIUS
    lock = Layer(Locked([state.rig.skeleton.names[2]]), Mask(vertices=HALF))
    correct.correct(painter, Edits(layers=[lock]))
    settled(painter, loop)
    edits = state.edits
    stroke(painter, MIDDLE)
    assert "is locked" in state.message[1]
    assert state.edits is edits
    state.message = None
    stroke(painter, MIDDLE + 1)
    settled(painter, loop)
    assert state.edits != edits


def texts(section):
    return [part for part in section.select(pmui.Typography) if isinstance(part.object, str)]


def test_a_selection_is_of_one_mesh(painter, loop):
    state = painter.state
    brush.select(painter, np.arange(len(state.rig.mesh.vertices)) < 5)
    assert selected(state).sum() == 5
    section = draw(painter, SELECTION)
    assert any("5 vertices of" in one.object and "limited" in one.object for one in texts(section))
    loading.load_demo(painter, "octopus")
    loop.rest(painter)
    assert selected(state) is None
