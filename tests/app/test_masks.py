"""Masks of layers on the page: changed by menu and brush, seen, undone, and part of the edits."""

import numpy as np
import panel_material_ui as pmui
import pytest

from cutcell import Edits, FromFile, Layer, Mask, Painted
from cutcell_app.editing.brush.strokes import select
from cutcell_app.editing.correct.commands import correct
from cutcell_app.editing.layers.commands import set_layer
from cutcell_app.editing.layers.controls import LAYERS
from cutcell_app.editing.layers.masks import MASKS
from cutcell_app.features.scenes import resolve
from cutcell_app.looks.mask import mask_strengths
from cutcell_app.looks.selection import neighbours_of
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import draw
from tests.app.loop import check_bound_as_by_core, settled
from tests.app.test_painting import MIDDLE, painter, stroke
from tests.viewers.arm import arm_rig

__all__ = ["painter"]
SOME = np.arange(10, 40)


@pytest.fixture
def layered(bound, loop):
    """Put a masked layer over the arm, and choose it."""
    correct(bound, Edits(layers=[Layer(FromFile(), Mask(vertices=SOME))]))
    bound.state.layer = 0
    settled(bound, loop)
    return bound


def test_the_menu_is_in_the_panel_while_a_layer_is_chosen(layered):
    menus = {one.label: one for one in draw(layered, LAYERS).select(pmui.MenuButton)}
    assert [item["label"] for item in menus["Mask"].items] == list(MASKS)


@pytest.mark.parametrize(
    "name",
    ["Selection only", "Add the selection", "Remove the selection",
     "Fill the selection with amount", "Grow", "Shrink", "Feather", "Invert", "Everywhere"],
)  # fmt: skip
def test_each_command_changes_the_mask_in_one_step_and_only_weights_there(layered, loop, name):
    state, before = layered.state, layered.state.weights
    base = correct_base(layered, loop)
    chosen = np.zeros(len(before), bool)
    chosen[30:60] = True
    select(layered, chosen)
    state.param.update(amount=0.25, passes=1)
    now = mask_strengths(state)
    MASKS[name](layered)
    settled(layered, loop)
    neighbours = neighbours_of(state)
    expected = {
        "Selection only": chosen,
        "Add the selection": (now > 0) | chosen,
        "Remove the selection": (now > 0) & ~chosen,
        "Fill the selection with amount": np.where(chosen, 0.25, now),
        "Grow": neighbours.grown(now > 0),
        "Shrink": neighbours.shrunk(now > 0),
        "Invert": now == 0,
        "Everywhere": np.ones(len(now)),
    }
    strengths = mask_strengths(state)
    if name == "Feather":
        assert ((strengths > 0) & (strengths < 1)).any()
        assert not strengths[~neighbours.grown(now > 0)].any()
    else:
        np.testing.assert_array_equal(strengths, expected[name])
    np.testing.assert_array_equal(state.weights[strengths == 0], base[strengths == 0])
    np.testing.assert_array_equal(state.weights[strengths == 1], state.rig.weights[strengths == 1])
    assert Edits.from_json(state.edits.to_json()) == state.edits
    check_bound_as_by_core(layered, arm_rig())
    assert state.weights_shown == "mask"
    np.testing.assert_array_equal(
        resolve(state).actors["body"].scalars, strengths.astype(np.float32)
    )
    keys.act(layered, "undo")
    settled(layered, loop)
    np.testing.assert_array_equal(state.weights, before)


def correct_base(session, loop):
    """Return the weights below the layer."""
    edits = session.state.edits
    correct(session, Edits())
    settled(session, loop)
    base = session.state.weights
    correct(session, edits)
    session.state.layer = 0
    settled(session, loop)
    return base


def test_a_mask_is_copied_to_another_layer(layered, loop):
    state = layered.state
    MASKS["Copy mask"](layered)
    other = Layer(Painted([0, 20], ["wrist"], [[1], [1]]))
    correct(layered, Edits(layers=[*state.edits.layers, other]))
    state.layer = 1
    assert np.flatnonzero(mask_strengths(state)).tolist() == [0, 20]
    MASKS["Paste mask"](layered)
    assert state.edits.layers[1].mask == Mask(vertices=SOME)


@pytest.mark.parametrize("name", MASKS)
def test_without_a_layer_or_what_a_command_needs_the_reason_is_told(bound, name):
    state, edits = bound.state, bound.state.edits
    state.layer = None
    MASKS[name](bound)
    assert "choose one under layers" in state.message[1].lower()
    assert state.edits == edits


def test_no_selection_and_no_copied_mask_are_told(layered):
    edits = layered.state.edits
    MASKS["Add the selection"](layered)
    assert "select some" in layered.state.message[1]
    MASKS["Paste mask"](layered)
    assert "copy one of another layer" in layered.state.message[1]
    assert layered.state.edits == edits


def test_the_brush_paints_and_erases_a_mask(painter, loop):
    state = painter.state
    state.brush_mode = "mask"
    stroke(painter, MIDDLE)
    assert "choose one under layers" in state.message[1].lower()
    correct(painter, Edits(layers=[Layer(FromFile(), Mask(vertices=[0]))]))
    state.param.update(layer=0, brush_strength=1.0, message=None)
    settled(painter, loop)
    assert state.weights_shown == "mask"
    stroke(painter, MIDDLE, MIDDLE + 1)
    settled(painter, loop)
    strengths = mask_strengths(state)
    assert strengths[MIDDLE] == 1
    assert strengths[0] == 1
    assert 0 < (strengths > 0).mean() < 1
    shown = painter.answers[-1]["painted"]
    np.testing.assert_allclose(shown["scalars"], strengths[shown["vertices"]], atol=1e-3)
    stroke(painter, MIDDLE, mode="subtract")
    settled(painter, loop)
    assert mask_strengths(state)[MIDDLE] == 0
    keys.act(painter, "undo")
    settled(painter, loop)
    np.testing.assert_array_equal(mask_strengths(state), strengths)
    state.brush_mode = "add"
    assert state.weights_shown == "bone"


@pytest.mark.parametrize("strength", [1.0, 0.5, 0.0])
def test_strokes_go_into_a_painted_layer_as_far_as_its_mask_lets_them(painter, loop, strength):
    state = painter.state
    whole = state.weights.copy()
    stroke(painter, MIDDLE)
    settled(painter, loop)
    delta = state.weights - whole
    painted = state.edits.layers[0].content.vertices
    mask = Mask()
    if strength < 1:
        rest = np.setdiff1d(np.arange(len(whole)), painted)
        inside = painted if strength else painted[:0]
        vertices = np.union1d(rest, inside)
        mask = Mask(vertices=vertices, strengths=np.where(np.isin(vertices, painted), 0.5, 1.0))
    set_layer(painter, 0, mask=mask)
    settled(painter, loop)
    first, edits = state.weights, state.edits
    np.testing.assert_allclose(first - whole, strength * delta, atol=1e-9)
    stroke(painter, MIDDLE)
    shown = painter.answers[-1]["painted"]
    settled(painter, loop)
    assert len(state.edits.layers) == 1
    assert state.layer == 0
    assert state.edits.layers[0].mask == mask
    assert (np.abs(state.weights - first).max() > 0.01) == (strength > 0)
    after = state.weights[shown["vertices"], state.joint]
    np.testing.assert_allclose(shown["scalars"], after, atol=2e-4)
    check_bound_as_by_core(painter, arm_rig())
    keys.act(painter, "undo")
    settled(painter, loop)
    assert state.edits == edits
    np.testing.assert_array_equal(state.weights, first)
