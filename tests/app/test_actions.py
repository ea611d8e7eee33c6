"""Each action that *Weights* declares has a name, is one step of undo, and travels in the edits."""

from collections.abc import Iterator

import numpy as np
import panel_material_ui as pmui
import pytest

from cutcell import Edits, FromFile, Layer, Mask, Painted
from cutcell_app.editing.brush.strokes import select
from cutcell_app.editing.correct.commands import correct
from cutcell_app.editing.layers.controls import LAYERS
from cutcell_app.editing.layers.masks import MASKS
from cutcell_app.editing.select import operations, saved
from cutcell_app.editing.select.bones import BONES
from cutcell_app.editing.select.controls import SELECTION
from cutcell_app.shell.session import keys
from cutcell_app.widgets.table import Control
from tests.app.loop import settled

SOME = np.arange(10, 40)
SECTIONS = {"layers": LAYERS, "bones": BONES, "selection": SELECTION}
TEXTS = {
    "Replace by table": "elbow -> wrist",
    "Vertices where": "weight of elbow > 0.5",
    "Save selection as": "arm",
    "Name of the layer": "new name",
}


def declared(session, row) -> Iterator[Control]:
    """Yield the controls of a table, with those inside of groups."""
    if isinstance(row, list | tuple):
        for one in row:
            yield from declared(session, one)
    elif isinstance(row, Control):
        yield row
        rows = row.content
        yield from declared(session, rows(session.state) if callable(rows) else rows)
    else:
        yield from declared(session, row(session))


def actions(session, table):
    """Yield name and function of each button, item of a menu and field of text."""
    for one in declared(session, table):
        shown = {**one.fixed, **one.shown(session.state)}
        label = shown.get("label", "")
        if one.kind is pmui.Button:
            yield label, lambda one=one: one.act(session, None)
        if one.kind is pmui.MenuButton:
            for item in shown["items"]:
                title = f"{label}: {item['label']}"
                yield title, lambda one=one, item=item: one.act(session, item)
        if one.kind is pmui.TextInput:
            yield label, lambda one=one, text=TEXTS[label]: one.act(session, text)


@pytest.fixture
def prepared(bound, loop):
    """Let all actions have what they need: masked layers, a selection, another bone, copies."""
    names = bound.state.rig.skeleton.names
    rows = np.tile([0.5, 0.25, 0.25], (len(SOME), 1))
    half = Mask(vertices=SOME[5:], strengths=np.full(len(SOME) - 5, 0.5))
    layers = [Layer(FromFile(), Mask(vertices=SOME)), Layer(Painted(SOME, names, rows), half),
              Layer(FromFile(), Mask(vertices=SOME[:3]))]  # fmt: skip
    correct(bound, Edits(layers=layers))
    chosen = np.isin(np.arange(len(bound.state.weights)), np.arange(20, 60))
    settled(bound, loop)
    select(bound, chosen)
    saved.save(bound, "leg")
    operations.copy(bound)
    bound.state.layer = 2
    MASKS["Copy mask"](bound)
    choices = {"joint": 1, "layer": 1, "other_bone": "wrist", "amount": 0.2, "saved": "leg",
               "brush_selection": bound.state.brush_selection, "move_from": "", "bars": (1, 9),
               "copied_mask": bound.state.copied_mask,
               "message": None, "bone_table": "", "condition": ""}  # fmt: skip
    bound.state.param.update(**choices)
    settled(bound, loop)
    return bound, choices


IDLE = ("Select", "Vertices where", "Mask: Copy", "Change weights: Copy", "Change weights: Paste",
        "Change weights: Normalise")  # fmt: skip
"""Beginnings of actions that choose or copy, or have nothing to change in such a character."""
REFUSED = ("Select by", "Change weights: Take the", "Change weights: Swap left",
           "Add layer: Left", "Add layer: Right", "Add layer: With the body")  # fmt: skip
"""Beginnings of actions that need a mirrored character, a finding, or several components."""


@pytest.mark.slow
@pytest.mark.parametrize("section", SECTIONS)
def test_each_action_is_undone_in_one_step_and_travels_in_the_edits(prepared, loop, section):
    session, choices = prepared
    state, refused, idle = session.state, [], []
    before, weights = state.edits, state.weights
    for name, act in list(actions(session, SECTIONS[section])):
        session.history.part()  # a person pauses
        act()
        loop.rest(session)
        message, edits = state.message, state.edits
        if edits == before:
            (idle if message is None or message[0] == "info" else refused).append(name)
        else:
            assert Edits.from_json(edits.to_json()) == edits, name
            changed = state.weights
            keys.act(session, "undo")
            loop.rest(session)
            assert state.edits == before, name
            np.testing.assert_array_equal(state.weights, weights, name)
            keys.act(session, "redo")
            loop.rest(session)
            assert state.edits == edits, name
            np.testing.assert_array_equal(state.weights, changed, name)
            keys.act(session, "undo")
            loop.rest(session)
        state.param.update(**choices)
        loop.rest(session)
    assert not [name for name in idle if not name.startswith(IDLE)]
    assert not [name for name in refused if not name.startswith(REFUSED)]
