"""Weights of stacks that change step by step: the same as those of each stack by itself."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

from cutcell import (
    ANIMATION,
    Computed,
    Filled,
    FromFile,
    Layer,
    Locked,
    Mask,
    Painted,
    Remapped,
    Smoothed,
)
from cutcell.editing.layers import RigSources, StackedRows, apply_layers, stacked
from tests.cutcell.diagnosis.worm import worm

WORM = worm()
COUNT, JOINTS = WORM.weights.shape
NAMES = WORM.skeleton.names
BASE = csr_array(np.roll(WORM.weights, 1, axis=1))
COMPUTED = np.roll(WORM.weights, 2, axis=0)


def fresh():
    """Return the weights of stacks, of which none is remembered."""
    sources = RigSources(WORM, ANIMATION.with_options(max_influences=3), None, lambda _: COMPUTED)
    return StackedRows(BASE, sources), sources


def check(rows, layers, sources):
    """Check that rows are those of a stack by itself, bit for bit."""
    expected = csr_array(apply_layers(BASE.toarray(), layers, sources))
    for name in ("indptr", "indices", "data"):
        assert np.array_equal(getattr(rows, name), getattr(expected, name)), name


vertices = st.builds(
    lambda start, size: np.arange(start, min(start + size, COUNT)),
    st.integers(0, COUNT - 1),
    st.integers(1, COUNT // 6),
)


@st.composite
def strokes(draw):
    """Draw rows of some vertices."""
    which, random = draw(vertices), np.random.default_rng(draw(st.integers(0, 9)))
    names = draw(st.permutations(NAMES))[: draw(st.integers(1, 3))]
    return Painted(which, names, random.integers(1, 4, (len(which), len(names))))


@st.composite
def masks(draw):
    """Draw a mask: of all vertices, or of some with strengths."""
    if draw(st.booleans()):
        return Mask()
    which = draw(vertices)
    strength = draw(st.sampled_from([None, 0.5, 1.0]))
    return Mask(vertices=which, strengths=strength and np.full(len(which), strength))


contents = st.one_of(
    strokes(),
    st.sampled_from(
        [Filled({NAMES[0]: 1}), Filled({NAMES[1]: 1, NAMES[2]: 2}), FromFile(), Smoothed(2),
         Remapped({NAMES[0]: NAMES[1]}), Locked(NAMES[:2]), Computed(gain={NAMES[0]: 2})]
    ),
)  # fmt: skip
layers = st.builds(
    Layer,
    contents,
    masks(),
    opacity=st.sampled_from([0.0, 0.4, 1.0]),
    mode=st.sampled_from(["replace", "add", "scale"]),
)


@settings(max_examples=40, deadline=None)
@given(data=st.data(), stack=st.lists(layers, max_size=3))
def test_each_step_gives_the_weights_of_its_stack_alone(data, stack):
    of_stacks, sources = fresh()
    history = [stack]
    check(of_stacks.rows(stack), stack, sources)
    for _ in range(6):
        now = [*history[-1]]
        act = data.draw(st.sampled_from(["paint", "insert", "change", "delete", "undo"]))
        place = data.draw(st.integers(0, len(now)))
        if act == "insert" or not now:
            now.insert(place, data.draw(layers))
        elif act == "undo":
            now = data.draw(st.sampled_from(history))
        elif act == "paint":
            one, stroke = now[place - 1], data.draw(strokes())
            is_painted = isinstance(one.content, Painted)
            content = one.content.merged(stroke) if is_painted else stroke
            now[place - 1] = replace(one, content=content)
        elif act == "change":
            other = data.draw(layers)
            name = data.draw(st.sampled_from(["mask", "opacity", "mode", "on", "name"]))
            value = {"on": not now[place - 1].on, "name": "another"}.get(name)
            value = getattr(other, name) if value is None else value
            now[place - 1] = replace(now[place - 1], **{name: value})
        else:
            del now[place - 1]
        history.append(now)
        check(of_stacks.rows(now), now, sources)


@pytest.mark.parametrize("above", [[], [Locked(NAMES[:1])]])
def test_a_stroke_computes_only_the_rows_that_it_changes(above, monkeypatch):
    of_stacks, sources = fresh()
    below = [Layer(Smoothed(2)), Layer(Filled({NAMES[0]: 1}), Mask(vertices=[3, 4]))]
    top = [Layer(one) for one in above]
    first = Painted([1, 2, 3, 4], NAMES[:1], np.ones((4, 1)))
    steps = [first, first.merged(Painted([4, 5, 6], NAMES[1:2], np.ones((3, 1)))), first]
    of_stacks.rows(below)
    of_stacks.rows([*below, *top])
    applied = []
    whole, some = stacked.apply_layers, stacked.apply_to_rows
    monkeypatch.setattr(
        stacked, "apply_layers", lambda *given: applied.append(None) or whole(*given)
    )
    monkeypatch.setattr(
        stacked, "apply_to_rows", lambda *given: applied.append(given[-1].tolist()) or some(*given)
    )
    for content in steps:
        stack = [*below, Layer(content), *top]
        check(of_stacks.rows(stack), stack, sources)
    assert applied == [[1, 2, 3, 4], [4, 5, 6]], "undo returns to what is remembered"
