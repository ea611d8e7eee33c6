"""Disagreement on the panel Compare, without a browser: regions, their pose, and what mends."""

from html import unescape

import numpy as np
import pytest

from cutcell.editing import Computed
from cutcell_app.document import loading
from cutcell_app.document.address import from_query, to_query
from cutcell_app.editing.correct.commands import choose_file
from cutcell_app.features.compare import results as comparing
from cutcell_app.features.compare.disagreement import results as disagreeing
from cutcell_app.features.compare.disagreement.controls import DISAGREEMENT
from cutcell_app.features.scenes import resolve
from cutcell_app.shell.session import keys
from cutcell_lab.disagreement import disagreement
from cutcell_lab.metrics import deformation_error
from tests.app.loop import settled
from tests.app.test_diagnosing import texts_of
from tests.viewers.arm import arm_rig


def damaged():
    """Let the end of the arm follow its root in the file."""
    rig = arm_rig()
    weights = rig.weights.copy()
    far = np.argsort(rig.mesh.vertices[:, 0])[-12:]
    weights[far] = np.eye(weights.shape[1])[0]
    return rig.with_weights(weights)


@pytest.fixture
def differing(session, loop):
    """Let a session show the damaged arm on the panel, its regions listed."""
    session.state.param.update(resolution=16, panel="compare")
    loading.show_rig(session, damaged())
    loop.run_until(lambda: session.state.disagreement is not None)
    settled(session, loop)
    return session


def chosen(session):
    disagreeing.look_at(session, session.state.disagreement.regions[0].key)
    return disagreeing.region_of(session.state)


def mean_error(state):
    return deformation_error(state.rig, state.binding.weights, state.rig.weights).mean


def test_the_regions_are_those_of_the_laboratory(differing):
    state = differing.state
    expected = disagreement(
        state.rig, state.binding.weights, state.rig.weights, state.binding.distances
    )
    assert [one.key for one in state.disagreement.regions] == [one.key for one in expected.regions]
    assert state.disagreement.errors.mean == pytest.approx(mean_error(state))
    text = unescape(texts_of(differing, DISAGREEMENT))
    first = expected.regions[0]
    assert f"{first.rms:.3g} mm (at most {first.largest:.3g} mm)" in text


def test_a_chosen_region_is_marked_in_each_view_and_posed_as_it_differs_most(differing):
    region = chosen(differing)
    description = resolve(differing.state)
    dots = [actor for name, actor in description.actors.items() if name.startswith("region ")]
    assert [actor.view for actor in dots] == list(range(len(differing.state.methods)))
    assert all(len(actor.points) == len(region.vertices) for actor in dots)
    mine, other = (
        dots[differing.state.methods.index(name)].points_in(description.pose)
        for name in ("now", "artist")
    )
    squared = np.square(mine - other).sum(axis=1)
    side = np.ptp(differing.state.rig.mesh.vertices, axis=0).max()
    assert 1e4 * squared.max() / side**2 == pytest.approx(region.turn.largest, rel=1e-2)  # lifted
    assert "Take this" in texts_of(differing, DISAGREEMENT)
    disagreeing.look_at(differing, region.key)
    assert differing.state.region == ""
    assert not differing.state.posed


def test_taking_a_region_lowers_the_error_by_its_part_in_one_step_of_undo(differing, loop):
    state, before = differing.state, mean_error(differing.state)
    region = chosen(differing)
    weights = state.binding.weights.copy()
    disagreeing.take(differing, "artist")
    settled(differing, loop)
    assert before - mean_error(state) == pytest.approx(region.error, rel=1e-3)
    np.testing.assert_allclose(
        state.binding.weights[region.vertices], state.rig.weights[region.vertices], atol=1e-9
    )
    rest = np.setdiff1d(np.arange(len(weights)), region.vertices)
    assert np.array_equal(state.binding.weights[rest], weights[rest])
    assert disagreeing.region_of(state) is None
    assert state.disagreement.errors.mean == pytest.approx(mean_error(state))


def test_a_blend_is_half_way(differing, loop):
    state, region = differing.state, chosen(differing)
    before = state.binding.weights[region.vertices]
    disagreeing.take(differing, "artist", 0.5)
    settled(differing, loop)
    half = (before + state.rig.weights[region.vertices]) / 2
    few = (half > 0).sum(axis=1) <= state.max_influences
    after = state.binding.weights[region.vertices]
    np.testing.assert_allclose(after[few], half[few], atol=1e-4)
    np.testing.assert_allclose(after.sum(axis=1), 1)
    assert ((after > 0).sum(axis=1) <= state.max_influences).all()


def test_keeping_a_region_is_a_step_of_undo_and_is_in_the_address(differing, loop):
    state, region = differing.state, chosen(differing)
    weights, listed = state.binding.weights, disagreeing.unsettled(differing.state)
    disagreeing.settle(differing)
    settled(differing, loop)
    assert state.binding.weights is weights
    assert disagreeing.unsettled(state) == [one for one in listed if one is not region]
    assert "List kept regions again" in texts_of(differing, DISAGREEMENT)
    _, entries, problems = from_query(to_query(state), state)
    assert entries["settled"] == state.settled
    assert problems == []
    keys.act(differing, "undo")
    assert disagreeing.unsettled(state) == listed
    keys.act(differing, "redo")
    assert region not in disagreeing.unsettled(state)
    disagreeing.list_all(differing)
    assert disagreeing.unsettled(state) == listed


@pytest.mark.parametrize("text", ["", "now", "now/artist/far/1/x", "now/artist/far/1/2,,"])
def test_an_address_with_other_keys_of_regions_is_a_problem(differing, text):
    _, entries, problems = from_query(f"?settled={text}", differing.state)
    assert "settled" not in entries
    assert problems == [f"settled={text}"]


def test_the_methods_that_are_compared_are_in_the_address_and_can_be_undone(session, loop):
    address = "?rig=robot&panel=compare&resolution=16&methods=now,artist,euclidean"
    pair = "&first_method=euclidean&second_method=artist"
    loading.arrive(session, address + pair)
    loop.run_until(lambda: session.state.rig is not None)
    state = session.state
    assert disagreeing.pair_of(state) == ("euclidean", "artist")
    assert pair in f"?{to_query(state)}"
    state.second_method = "now"
    assert "second_method=now" in session.view.last_sent("address")
    keys.act(session, "undo")
    assert disagreeing.pair_of(state) == ("euclidean", "artist")
    # The browser's Back, to an address without and with a pair.
    session.view._handle_msg({"type": "visit", "query": address})
    loop.run_until(lambda: "first_method" not in session.view.last_sent("address"))
    assert disagreeing.pair_of(state) == ("now", "artist")
    session.view._handle_msg({"type": "visit", "query": address + pair})
    loop.run_until(lambda: pair in session.view.last_sent("address"))
    assert disagreeing.pair_of(state) == ("euclidean", "artist")
    comparing.choose(session, "euclidean", False)
    assert "first_method" not in to_query(state)


def test_two_methods_besides_the_current_weights_are_compared(differing, loop):
    state = differing.state
    state.param.update(methods=["now", "artist", "euclidean"], first_method="euclidean")
    loop.run_until(lambda: "euclidean" in state.compared)
    settled(differing, loop)
    other = state.compared["euclidean"].weights
    errors = deformation_error(state.rig, other, state.rig.weights)
    assert state.disagreement.errors.mean == pytest.approx(errors.mean)
    chosen(differing)
    text = unescape(texts_of(differing, DISAGREEMENT))
    assert "Take “Euclidean”" in text
    assert "Take the file" in text
    assert "Blend" not in text
    state.second_method = "euclidean"  # never both
    assert disagreeing.pair_of(state) == ("euclidean", "artist")


def test_another_method_can_be_taken(differing, loop):
    state = differing.state
    state.param.update(methods=["now", "artist", "euclidean"], second_method="euclidean")
    loop.run_until(lambda: "euclidean" in state.compared)
    settled(differing, loop)
    assert state.disagreement.regions
    region = chosen(differing)
    expected = state.compared["euclidean"].weights[region.vertices]
    disagreeing.take(differing, "euclidean")
    settled(differing, loop)
    after = state.binding.weights[region.vertices]
    most = np.argmax(expected, axis=1)
    assert (after.argmax(axis=1) == most).mean() > 0.9


def test_taking_a_method_of_the_core_puts_a_layer_that_computes_it(differing, loop):
    state = differing.state
    state.param.update(methods=["now", "cutcell"], max_influences=8)
    loop.run_until(lambda: "cutcell" in state.compared)
    settled(differing, loop)
    region = chosen(differing)
    expected = state.compared["cutcell"].weights[region.vertices]
    disagreeing.take(differing, "cutcell")
    settled(differing, loop)
    [layer] = state.edits.layers
    assert isinstance(layer.content, Computed)
    np.testing.assert_allclose(state.binding.weights[region.vertices], expected, atol=1e-6)


def test_weights_that_agree_are_said_to(differing, loop):
    choose_file(differing, from_file=True)
    settled(differing, loop)
    assert differing.state.disagreement.regions == ()
    assert "The weights move the surface alike" in texts_of(differing, DISAGREEMENT)
