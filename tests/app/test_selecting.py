"""Selections on the page: what is selected, what is shown of it, and what changes its weights."""

from dataclasses import replace

import numpy as np
import panel_material_ui as pmui
import pytest

from cutcell import Edits, Layer, Locked, Mask
from cutcell_app.document import loading
from cutcell_app.document.selection import selected
from cutcell_app.editing.brush.strokes import select
from cutcell_app.editing.compute import operations as ops
from cutcell_app.editing.compute.selected import Selected
from cutcell_app.editing.correct.commands import choose_file, correct
from cutcell_app.editing.layers.commands import STEPS
from cutcell_app.editing.select import operations, saved, selections
from cutcell_app.editing.select.controls import SELECTION, WEIGHT_SCALE
from cutcell_app.editing.select.operations import OPERATIONS
from cutcell_app.editing.select.selections import SELECTIONS
from cutcell_app.editing.select.table import FILE, ROWS, VERTEX
from cutcell_app.features.scenes import resolve
from cutcell_app.looks.histogram import BARS, bar_of
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import draw
from cutcell_app.widgets.weights_table import Histogram, WeightsTable
from tests.app.loop import settled
from tests.app.small import small_rig


def some(session, share=0.3):
    """Select some vertices at random."""
    count = len(session.state.rig.mesh.vertices)
    chosen = np.random.default_rng(0).random(count) < share
    select(session, chosen)
    return chosen


def hear(session, kind, **message):
    """Send a message as the browser does."""
    session.view._handle_msg({"type": kind, **message})


def test_a_lasso_selects_adds_and_subtracts(bound, loop):
    state = bound.state
    keys.act(bound, "lasso")
    assert state.lasso
    assert bound.view.last_sent("lasso") == {"through": False}
    hear(bound, "lasso", vertices=[1, 2, 3], mode="replace")
    hear(bound, "lasso", vertices=[3, 5], mode="add")
    assert np.flatnonzero(selected(state)).tolist() == [1, 2, 3, 5]
    hear(bound, "lasso", vertices=[2, 10**9, -1], mode="subtract")
    assert np.flatnonzero(selected(state)).tolist() == [1, 3, 5]
    hear(bound, "lasso", vertices=[], mode="replace")
    assert selected(state) is None
    hear(bound, "lasso", vertices=[2], mode="subtract")
    assert selected(state) is None
    state.brush = True
    assert not state.lasso, "one tool at a time"
    assert bound.view.last_sent("lasso") is None
    state.lasso = True
    assert not state.brush
    state.panel = "graph"
    loop.rest(bound)
    assert bound.view.last_sent("lasso") is None
    hear(bound, "lasso", vertices=[2], mode="replace")
    assert selected(state) is None


def test_keys_grow_shrink_and_isolate_the_selection(bound):
    state = bound.state
    keys.act(bound, "select all")
    assert selected(state).all()
    keys.act(bound, "select none")
    assert selected(state) is None
    for name in ("grow", "shrink"):
        keys.act(bound, name)
        assert selected(state) is None
    select(bound, np.arange(len(state.rig.mesh.vertices)) == 40)
    sizes = []
    for name in ("grow", "grow", "shrink", "shrink"):
        keys.act(bound, name)
        sizes.append(selected(state).sum())
    assert 1 < sizes[0] <= sizes[2] < sizes[1]
    assert sizes[3] < sizes[2]
    keys.act(bound, "grow")
    whole = resolve(state).actors
    keys.act(bound, "isolate")
    actors = resolve(state).actors
    cells = actors["body"].cells
    assert 0 < len(cells) < len(whole["body"].cells)
    assert selected(state)[cells].any(axis=1).all()
    assert not any(name.startswith("attachment") for name in actors)
    state.panel = "pose"
    assert len(resolve(state).actors["body"].cells) == len(cells)
    keys.act(bound, "isolate")
    assert len(resolve(state).actors["body"].cells) == len(whole["body"].cells)
    state.panel = "graph"
    keys.act(bound, "select all")
    assert not selected(state).all(), "keys do nothing where no weights are in sight"


def test_s_chooses_the_strongest_bone(bound):
    state = bound.state
    for vertex in (0, 30, 60):
        hear(bound, "pick-strongest", vertex=vertex)
        assert state.joint == state.weights[vertex].argmax()
        assert state.weights_shown == "bone"
    hear(bound, "pick-strongest", vertex=10**6)
    assert state.joint == state.weights[60].argmax()


def test_selections_of_the_menu(bound):
    state = bound.state
    state.joint = 1
    weights = state.weights
    SELECTIONS["Vertices of the bone"](bound)
    assert np.array_equal(selected(state), weights[:, 1] > 0)
    SELECTIONS["Bone and its children"](bound)
    assert np.array_equal(selected(state), weights[:, 1:].sum(axis=1) > 0.5)
    SELECTIONS["None"](bound)
    for name in ("Connected part", "Mesh of the file"):
        SELECTIONS[name](bound)
        assert "no part is chosen" in state.message[1].lower()
        state.vertex = 3
        SELECTIONS[name](bound)
        assert selected(state).all(), "it is all of one piece"
        SELECTIONS["None"](bound)
        state.param.update(vertex=None, message=None)
    SELECTIONS["Finding chosen in Check"](bound)
    assert "choose one in check" in state.message[1].lower()


def test_vertices_of_a_finding_are_selected(session, loop):
    session.state.param.update(resolution=16, graph_resolution=0)
    loading.show_rig(session, small_rig())
    loop.rest(session)
    state = session.state
    code = "boneless-components"
    state.param.update(panel="check", finding=code)
    assert len(state.selected_finding.vertices)
    SELECTIONS["Finding chosen in Check"](session)
    assert state.panel == "weights"
    assert np.array_equal(np.flatnonzero(selected(state)), state.diagnosis[code].vertices)
    # The box above the head is all of its component.
    SELECTIONS["Grow"](session)
    SELECTIONS["Connected part"](session)
    assert np.array_equal(np.flatnonzero(selected(state)), state.diagnosis[code].vertices)


def test_enter_applies_the_same_condition_again(bound, loop):
    field = next(one for one in draw(bound, SELECTION).select(pmui.TextInput))
    field.value = "weight of elbow > 0.5"
    chosen = selected(bound.state)
    select(bound, np.zeros(len(chosen), bool))
    assert selected(bound.state) is None
    field.param.trigger("enter_pressed")
    np.testing.assert_array_equal(selected(bound.state), chosen)
    loading.show_rig(bound, small_rig())
    assert field.value == ""


def test_a_condition_selects_and_one_that_cannot_be_read_is_told(bound):
    state = bound.state
    section = draw(bound, SELECTION)
    box = next(one for one in section.select(pmui.TextInput) if one.label == "Vertices where")
    box.value = "weight of elbow > 0.5 and distance < 0.4"
    far = state.binding.distances.on_mesh(1) * state.graph.lattice.size
    assert np.array_equal(selected(state), (state.weights[:, 1] > 0.5) & (far < 0.4))
    before = selected(state)
    box.value = "weight of knee > 1"
    assert 'there is no joint "knee"' in state.message[1].lower()
    box.value = "weight of wrist > 1"
    assert state.message == ("info", "No vertices fit. The selection has not changed.")
    assert selected(state) is before


@pytest.mark.parametrize("name", OPERATIONS)
def test_operations_change_only_the_selection_in_one_step(bound, loop, name):
    state = bound.state
    state.joint = 1
    chosen, before = some(bound), state.weights
    if name.startswith("Paste"):
        operations.copy(bound)
        if "nearest" in name:
            select(bound, ~chosen)
            chosen = ~chosen
    OPERATIONS[name](bound)
    settled_or_told(bound, loop)
    if name.startswith("Take the") or name == "Swap left and right":
        assert "no joint has a partner" in state.message[1].lower()
        return
    after = state.weights
    assert np.array_equal(after[~chosen], before[~chosen])
    np.testing.assert_allclose(after.sum(axis=1), 1, atol=1e-9)
    assert (after >= 0).all()
    if (after == before).all():
        assert name in ("Copy weights", "Normalise", "Paste in vertex order"), name
        return
    keys.act(bound, "undo")
    loop.rest(bound)
    assert np.array_equal(state.weights, before)


def settled_or_told(session, loop):
    loop.rest(session)
    assert session.state.message is None or session.state.message[0] == "error"


def test_operations_give_what_the_core_gives(bound, loop):
    state = bound.state
    state.param.update(joint=2, amount=0.3)
    chosen, before = some(bound), state.weights
    rows = Selected(state.rig, before, np.flatnonzero(chosen), (), state.max_influences)
    cases = {"fill": ops.fill(rows, 2, 0.3), "move weight": ops.move_weight(rows, [0, 1, 2], 2)}
    for act, expected in cases.items():
        keys.act(bound, act)
        settled(bound, loop)
        np.testing.assert_allclose(state.weights[chosen], expected, atol=1 / STEPS)
        keys.act(bound, "undo")
        loop.rest(bound)


def test_the_weight_of_one_bone_moves_to_the_chosen_one(bound, loop):
    state = bound.state
    chosen, before, names = some(bound), state.weights, state.rig.skeleton.names
    source = int(before[chosen].sum(axis=0).argmax())
    target = (source + 1) % len(names)
    state.joint = target
    pick = next(
        one for one in draw(bound, SELECTION).select(pmui.Select) if one.label == "Move weight of"
    )
    assert pick.value == "All bones"
    pick.value = pick.options[source + 1]
    assert state.move_from == names[source]
    keys.act(bound, "move weight")
    settled(bound, loop)
    after = state.weights
    assert not after[chosen, source].any()
    expected = before[:, [source, target]].sum(axis=1)
    np.testing.assert_allclose(after[chosen, target], expected[chosen], atol=2 / STEPS)
    assert np.array_equal(after[~chosen], before[~chosen])
    edits = state.edits
    keys.act(bound, "move weight")
    assert "has no weight at the selected vertices" in state.message[1]
    state.joint = source
    keys.act(bound, "move weight")
    assert "another bone" in state.message[1]
    assert state.edits is edits
    state.move_from = "a bone of another character"
    assert pick.value == "All bones"


def test_nothing_is_changed_without_a_selection_or_where_a_joint_is_locked(bound, loop):
    state = bound.state
    OPERATIONS["Smooth"](bound)
    assert "no vertices are selected" in state.message[1].lower()
    some(bound)
    OPERATIONS["Paste by nearest point"](bound)
    assert "nothing was copied" in state.message[1].lower()
    edits = state.edits
    state.param.update(joint=0, message=None)
    keys.act(bound, "copy")
    names, points, rows = state.copied
    state.copied = ((*names[:-1], "other"), points, rows)
    keys.act(bound, "paste")
    assert "another skeleton" in state.message[1].lower()
    assert state.edits is edits


def test_operations_respect_locks_of_some_vertices(bound, loop):
    state = bound.state
    chosen, names, in_file = some(bound), state.rig.skeleton.names, state.rig.weights
    half = np.flatnonzero(chosen)[::2]
    correct(bound, Edits(layers=[Layer(Locked([names[2]]), Mask(vertices=half))]))
    state.param.update(joint=2, amount=0.3)
    settled(bound, loop)
    before = state.weights
    for act in ("fill", "move weight"):
        keys.act(bound, act)
        settled(bound, loop)
        assert np.array_equal(state.weights[half, 2], in_file[half, 2])
        rest = np.setdiff1d(np.flatnonzero(chosen), half)
        rows = Selected(state.rig, before, rest, (), state.max_influences)
        cases = {"fill": ops.fill(rows, 2, 0.3), "move weight": ops.move_weight(rows, [0, 1, 2], 2)}
        np.testing.assert_allclose(state.weights[rest], cases[act], atol=1 / STEPS)
        keys.act(bound, "undo")
        settled(bound, loop)
    select(bound, np.isin(np.arange(len(chosen)), half))
    for act in ("fill", "move weight"):
        state.message = None
        keys.act(bound, act)
        assert "is locked" in state.message[1]
    assert np.array_equal(state.weights, before)


def test_one_click_puts_a_layer_over_the_selection(bound, loop):
    state = bound.state
    chosen, computed, in_file = some(bound), state.weights, state.rig.weights
    buttons = {one.label: one for one in draw(bound, SELECTION).select(pmui.Button)}

    def click(label, expected):
        buttons[label].clicks += 1
        settled(bound, loop)
        np.testing.assert_allclose(state.weights[chosen], expected[chosen], atol=1e-12)
        assert np.array_equal(state.weights[~chosen], before[~chosen])
        assert state.layer == len(state.edits.layers) - 1
        assert state.edits.layers[-1].mask.vertices.tolist() == np.flatnonzero(chosen).tolist()

    before = computed
    click("Take from file here", in_file)
    click("Recompute here", computed)
    assert np.array_equal(state.weights, computed)
    buttons["Blend with file"].clicks += 1
    settled(bound, loop)
    assert state.edits.layers[-1].opacity == 0.5
    assert state.edits.layers[-1].title == "Blend"
    choose_file(bound, True)
    settled(bound, loop)
    before = state.weights
    assert np.array_equal(before[~chosen], in_file[~chosen])
    click("Recompute here", computed)
    assert buttons["Blend with file"].label == "Blend with computed"
    OPERATIONS["Lock the bone to file weights"](bound)
    settled(bound, loop)
    joint = state.joint
    np.testing.assert_allclose(state.weights[:, joint], in_file[:, joint], atol=1e-9)
    assert np.array_equal(state.weights[~chosen], before[~chosen])


def test_operations_name_their_layers(bound, loop):
    state = bound.state
    state.joint = 2
    some(bound)
    keys.act(bound, "move weight")
    settled(bound, loop)
    assert state.edits.layers[-1].title == "Move to wrist"


def test_a_mirrored_character_takes_one_side(session, loop):
    session.state.param.update(resolution=16, graph_resolution=0)
    loading.show_rig(session, small_rig())
    loop.rest(session)
    state = session.state
    state.message = None
    x = state.rig.mesh.vertices[:, 0]
    names = state.rig.skeleton.names
    state.joint = names.index("hand.L")
    select(session, x > 0.9)
    keys.act(session, "fill")
    loop.rest(session)
    left = state.weights[x > 0.9]
    OPERATIONS["Take the left side"](session)
    loop.rest(session)
    assert np.array_equal(state.weights[x > 0.9], left)
    right = state.weights[x < -0.9]
    partner = [names.index(name.translate(str.maketrans("LR", "RL"))) if name[-2:] in (".L", ".R")
               else i for i, name in enumerate(names)]  # fmt: skip
    order, other = (
        np.lexsort((np.round(state.rig.mesh.vertices[side] * [sign, 1, 1], 6)).T)
        for side, sign in ((x > 0.9, 1), (x < -0.9, -1))
    )
    np.testing.assert_allclose(right[other][:, partner], left[order], atol=2 / STEPS)
    before = state.weights
    OPERATIONS["Swap left and right"](session)
    loop.rest(session)
    np.testing.assert_allclose(state.weights[x > 0.9], left[:, partner], atol=2 / STEPS)
    assert np.array_equal(state.weights[x <= 0.9], before[x <= 0.9])


def test_the_table_shows_sorts_and_edits_weights(bound, loop):
    state = bound.state
    state.joint = 1
    chosen = some(bound, 0.6)
    section = draw(bound, SELECTION)
    (table,) = section.select(WeightsTable)
    assert table.content == {}
    state.table = True
    loop.rest(bound)
    assert table.content["columns"][:3] == [["Vertex", VERTEX], ["elbow", 1], ["File", FILE]]
    assert len(table.content["rows"]) == min(ROWS, chosen.sum())
    weights = [row[1] for row in table.content["rows"]]
    assert weights == sorted(weights, reverse=True)
    for vertex, weight, in_file, *_ in table.content["rows"]:
        assert weight == round(state.weights[vertex, 1], 4)
        assert in_file == round(state.rig.weights[vertex, 1], 4)
    total, mean = table.content["totals"]
    assert total[1] == round(state.weights[chosen, 1].sum(), 4)
    assert mean[2] == round(state.rig.weights[chosen, 1].mean(), 4)
    table._handle_msg({"type": "sort", "column": 1})
    loop.rest(bound)
    assert [row[1] for row in table.content["rows"]] == sorted(state.weights[chosen, 1].round(4))[
        :ROWS
    ]
    table._handle_msg({"type": "sort", "column": VERTEX})
    table._handle_msg({"type": "page", "page": 1})
    loop.rest(bound)
    assert [row[0] for row in table.content["rows"]] == np.flatnonzero(chosen)[
        ROWS : 2 * ROWS
    ].tolist()
    vertex = table.content["rows"][0][0]
    table._handle_msg({"type": "edit-weight", "vertex": vertex, "joint": 1, "value": 0.25})
    settled(bound, loop)
    assert state.weights[vertex, 1] == pytest.approx(0.25, abs=1 / STEPS)
    assert table.content["rows"][0][1] == 0.25
    table._handle_msg({"type": "pick-vertex", "vertex": vertex})
    assert state.vertex == vertex
    keys.act(bound, "select none")
    loop.rest(bound)
    assert table.content == {}


def test_the_table_stays_sorted_by_a_joint_whose_column_moves(bound, loop):
    state = bound.state
    state.param.update(joint=0, table=True)
    some(bound, 0.6)
    (table,) = draw(bound, SELECTION).select(WeightsTable)
    loop.rest(bound)
    places = []
    table._handle_msg({"type": "sort", "column": 1})
    for joint in (0, 2, 1):
        state.joint = joint
        loop.rest(bound)
        columns = [column for _, column in table.content["columns"]]
        places.append(columns.index(1))
        weights = [row[columns.index(1)] for row in table.content["rows"]]
        assert weights == sorted(weights, reverse=True)
        assert table.content["order"] == [1, True]
    assert len(set(places)) > 1


def test_bars_of_the_histogram_hold_the_vertices_of_their_weights(bound, loop):
    state = bound.state
    state.joint = 1
    section = draw(bound, SELECTION)
    (histogram,) = section.select(Histogram)
    assert histogram.bars == []
    state.histogram = True
    loop.rest(bound)
    weight = state.weights[:, 1]
    for bar, (_, count) in enumerate(histogram.bars):
        above, up_to = bar / BARS, (bar + 1) / BARS
        assert count == ((weight > above + 1e-9) & (weight <= up_to + 1e-9)).sum()
    histogram._handle_msg({"type": "pick-bars", "first": 0, "last": 9})
    within = (weight > 0) & (weight <= 0.5 + 1e-9)
    assert len(resolve(state).actors["selection"].points) == within.sum()
    selections.select_bars(bound)
    assert np.array_equal(selected(state), within)
    assert state.bars is None
    loop.rest(bound)
    assert sum(count for _, count in histogram.bars) == within.sum()
    histogram._handle_msg({"type": "pick-bars", "first": 0, "last": BARS})
    assert state.bars is None, "there is no such bar"
    assert np.array_equal(bar_of(np.array([0, 1e-9, 0.05, 0.0501, 1.0])), [-1, 0, 0, 1, BARS - 1])


def test_faint_weights_are_seen_by_other_scales_and_the_outline(bound):
    state = bound.state
    state.param.update(joint=1, weights_shown="bone")
    weight = state.weights[:, 1]
    actors = resolve(state).actors
    assert np.array_equal(actors["body"].scalars, weight.astype(np.float32))
    assert len(actors["weight outline"].points)
    state.weight_outline = False
    assert "weight outline" not in resolve(state).actors
    state.weight_scale = "log"
    body = resolve(state).actors["body"]
    expected = np.clip(1 + np.log10(np.maximum(weight, 1e-9)) / 3, 0, 1)
    np.testing.assert_allclose(body.scalars, expected, atol=1e-6)
    np.testing.assert_allclose(body.reading.values, weight, atol=1e-6)
    state.param.update(weight_scale="limit", weight_limit=0.3)
    scene = resolve(state)
    assert np.array_equal(scene.actors["body"].scalars > 0, weight.astype(np.float32) > 0.3)
    assert "above 0.3" in scene.legend.title
    section = draw(bound, WEIGHT_SCALE)
    assert section.visible
    state.weights_shown = "mix"
    assert not section.visible


def test_tools_are_neither_undone_nor_in_the_address(bound, loop):
    state = bound.state
    some(bound)
    state.param.update(lasso=True, isolated=True, table=True, histogram=True, amount=0.7, passes=9)
    assert not bound.history.can_undo
    address = bound.view.last_sent("address")
    assert not any(name in address for name in ("lasso", "isolated", "table", "amount", "passes"))
    state.weight_scale = "log"
    assert "weight_scale=log" in bound.view.last_sent("address")
    own = state.rig
    loading.show_rig(bound, replace(own, name="another"))
    loop.rest(bound)


def test_selections_are_saved_by_name_with_the_edits(bound, loop):
    state = bound.state
    chosen, before = some(bound), state.weights
    saved.save(bound, " hand ")
    loop.rest(bound)
    assert np.array_equal(state.weights, before)
    assert Edits.from_json(state.edits.to_json()) == state.edits
    keys.act(bound, "select none")
    menu = next(
        one for one in draw(bound, SELECTION).select(pmui.Select) if one.label == "Saved selection"
    )
    menu.value = "None"
    assert selected(state) is None
    menu.value = "hand"
    assert np.array_equal(selected(state), chosen)
    saved.forget(bound)
    assert not state.edits
    keys.act(bound, "undo")
    loop.rest(bound)
    assert [*state.edits.selections] == ["hand"]
    keys.act(bound, "select none")
    saved.save(bound, "foot")
    assert "select some to save them" in state.message[1]


def test_sides_are_selected_by_the_menu(session, loop):
    session.state.param.update(resolution=16, graph_resolution=0)
    loading.show_rig(session, small_rig())
    loop.rest(session)
    x = session.state.rig.mesh.vertices[:, 0]
    for name, expected in (("Left side", x > 1e-2), ("Right side", x < -1e-2)):
        SELECTIONS[name](session)
        assert np.array_equal(selected(session.state), expected), name
