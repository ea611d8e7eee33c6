"""Any sequence of changes of a stack of layers is undone and redone exactly."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cutcell
from cutcell import Computed, Edits, Filled, FromFile, Layer, Locked, Mask, Painted, Smoothed
from cutcell.editing.layers import apply_layers
from cutcell.editing.layers.sources import RigSources
from cutcell_app.document.document import Document, History
from cutcell_app.editing.compute import stack
from tests.viewers.arm import arm_rig

NAMES = arm_rig().skeleton.names
COUNT = len(arm_rig().mesh.vertices)

joint = st.sampled_from(NAMES)
some = st.sets(st.integers(0, COUNT - 1), min_size=1, max_size=6).map(sorted)
fraction = st.floats(0, 1)
painting = some.flatmap(
    lambda vertices: st.lists(
        st.tuples(st.floats(0.01, 1), fraction), min_size=len(vertices), max_size=len(vertices)
    ).map(lambda rows: Painted(vertices, NAMES[:2], rows))
)
content = st.one_of(
    painting,
    st.builds(FromFile),
    st.builds(Smoothed, st.integers(1, 3), st.booleans()),
    joint.map(lambda name: Filled({name: 1})),
    joint.map(lambda name: Locked([name])),
)
mask = st.one_of(st.just(Mask()), st.just(Mask(part=0)), some.map(lambda v: Mask(vertices=v)))
layer = st.builds(Layer, content, mask, st.text(max_size=3), fraction, st.booleans())
place = st.integers(0, 99)
ACTIONS = st.one_of(
    st.tuples(st.just("put"), layer),
    st.tuples(st.just("delete"), place),
    st.tuples(st.just("opacity"), place, fraction),
    st.tuples(st.just("switch"), place),
    st.tuples(st.just("move"), place, st.sampled_from((-1, 1))),
    st.tuples(st.just("paint"), place, painting),
    st.tuples(st.just("unpaint"), some),
    st.tuples(st.just("lock"), joint, st.booleans()),
    st.tuples(st.just("reach"), joint, st.floats(0.5, 2), st.none() | st.floats(0.1, 1)),
    st.tuples(st.just("base"), st.booleans()),
    st.tuples(st.just("part"), st.none() | joint.map(lambda name: Filled({name: 1}))),
)


def act(edits, name, *values):
    """Return edits after an action on the page."""
    layers = edits.layers
    if name in ("delete", "opacity", "switch", "move", "paint") and layers:
        where = values[0] % len(layers)
        one = layers[where]
        if name == "move":
            by = values[1] if 0 <= where + values[1] < len(layers) else 0
            return stack.moved(edits, where, by)[0]
        if name == "paint":
            return stack.painted(edits, values[1], where, "")[0]
        changed = {
            "delete": lambda: None,
            "opacity": lambda: replace(one, opacity=values[1]),
            "switch": lambda: replace(one, on=not one.on),
        }[name]()
        return stack.replaced(edits, where, changed)
    others = {
        "put": lambda layer: stack.put_layer(edits, layer)[0],
        "unpaint": lambda vertices: stack.without_painted(edits, np.array(vertices)),
        "lock": lambda name, on: stack.with_locks(edits, [name], on),
        "reach": lambda *reach: stack.with_reach(edits, *reach),
        "base": lambda from_file: stack.with_base(edits, from_file),
        "part": lambda content: stack.with_part(edits, range(COUNT), content),
    }
    return others[name](*values) if name in others else edits


@pytest.fixture(scope="module")
def weights_of():
    rows = np.random.default_rng(3).dirichlet(np.ones(len(NAMES)), COUNT)
    rig = arm_rig().with_weights(rows)
    binding = cutcell.bind(rig, 12)
    sources = RigSources(rig, binding.method, binding.graph, computed=lambda layer: rows)
    return lambda edits: apply_layers(binding.weights, edits.stack(), sources)


def documented(edits):
    return Document("", None, None, None, edits, {})


@settings(max_examples=60)
@given(st.lists(ACTIONS, max_size=12))
def test_any_sequence_is_undone_and_redone_to_the_bit(weights_of, actions):
    edits = Edits()
    history, seen = History(documented(edits)), [(edits.to_json(), weights_of(edits))]
    for time, (name, *values) in enumerate(actions):
        new = act(edits, name, *values)
        if new == edits:  # it is no step
            continue
        edits = new
        history.note(documented(edits), 10.0 * time)
        weights = weights_of(edits)
        assert (weights >= 0).all()
        np.testing.assert_allclose(weights.sum(axis=1), 1)
        seen.append((edits.to_json(), weights))
    for by, expected in ((-1, seen[-2::-1]), (1, seen[1:])):
        for text, weights in expected:
            history.go(by, history.peek(by))
            then = history.now.edits
            assert then.to_json() == text
            assert Edits.from_json(text) == then
            np.testing.assert_array_equal(weights_of(then), weights)
        assert history.peek(by) is None


def test_the_file_is_not_hidden_by_the_reach_of_joints():
    edits = stack.with_reach(Edits(), NAMES[0], 2.0, None)
    over_file = stack.with_base(edits, True)
    assert over_file.stack()[0] == Layer(FromFile())
    assert over_file.reach == Computed()
    assert stack.with_base(over_file, False) == edits
