"""Why a vertex has its weights: the card and the paths, without a browser."""

import pytest

from cutcell_app.document.look import pick_vertex
from cutcell_app.features.inspector.facts import vertex_facts
from cutcell_app.features.scenes import resolve


@pytest.fixture
def explained(bound, loop):
    bound.state.panel = "weights"
    bound.state.explain = True
    pick_vertex(bound, 7)
    loop.run_until(lambda: bound.state.explanation is not None)
    return bound


def test_the_steps_end_with_the_weights_that_are_shown(explained):
    state = explained.state
    reports = vertex_facts(state)["why"]
    weights = {bone["joint"]: bone["steps"][-1][1] for bone in reports}
    assert weights == pytest.approx({j: state.binding.weights[7, j] for j in weights})
    assert sum(weights.values()) == pytest.approx(1)
    heaviest = reports[0]
    assert heaviest["distance"] >= 0.999 * heaviest["straight"] > 0
    assert heaviest["file"] == state.rig.weights[7, heaviest["joint"]]
    paths = sum(length for kind, length in heaviest["path"])
    assert paths == pytest.approx(heaviest["distance"], rel=0.05)


def test_its_paths_are_drawn_in_the_joints_colours(explained):
    drawn = [name for name in resolve(explained.state).actors if name.startswith("path to ")]
    assert drawn
    reports = vertex_facts(explained.state)["why"]
    assert {f"path to {bone['joint']}" for bone in reports if bone["steps"][-1][1]} == {*drawn}
    explained.state.explain = False
    assert not [name for name in resolve(explained.state).actors if name.startswith("path to ")]


def test_other_weights_are_explained_anew(explained, loop):
    explained.state.max_influences = 1
    assert explained.state.explanation is None
    loop.run_until(lambda: explained.state.explanation is not None)
    reports = vertex_facts(explained.state)["why"]
    assert [bone["steps"][-1][1] for bone in reports] == [1.0] + [0.0] * (len(reports) - 1)


def test_nothing_is_explained_unless_it_is_asked_for(bound):
    pick_vertex(bound, 7)
    assert ("explanation",) not in bound.state.computing
    assert vertex_facts(bound.state)["why"] == []


def test_the_chosen_joint_says_why_it_has_no_weight(explained, loop):
    state = explained.state
    absent = int(state.binding.weights[7].argmin())
    assert state.binding.weights[7, absent] == 0
    before = state.explanation
    state.joint = absent
    assert state.explanation is before, "the older one stays until the new one is there"
    loop.run_until(lambda: state.explanation is not before)
    (bone,) = [one for one in vertex_facts(state)["why"] if one["chosen"]]
    assert bone["joint"] == absent
    assert bone["absence"].endswith(".")
    assert (f"path to {absent}" in resolve(state).actors) == bool(bone["path"])
