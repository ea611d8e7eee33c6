"""Measures side by side on the panel Distance, from state to scene."""

import numpy as np
import pytest

import cutcell
from cutcell_app.derive.derived import ComputedWhenRead
from cutcell_app.document import loading
from cutcell_app.document.address import from_query, to_query
from cutcell_app.features.distance.measures import WAITING
from cutcell_app.features.distance.results import RESULTS
from cutcell_app.features.distance.scene import farthest, wants_field
from cutcell_app.features.inspector.facts import vertex_facts
from cutcell_app.features.scenes import following, resolve
from cutcell_app.features.state import PageState
from cutcell_app.looks.measures import MEASURES as NAMED
from cutcell_lab.baselines.measured_distance import (
    MEASURES,
    mean_error,
    measure_distance,
)
from cutcell_viewers.distance_scene import longest_side
from cutcell_viewers.palette import BODY
from tests.viewers.arm import arm_rig


@pytest.fixture
def state(rig, binding):
    state = PageState(rig=rig, binding=binding, joint=1, panel="distance", beside_resolution=16)
    state.param.update(beside_straight=True, beside_voxel=True, beside_any=True)
    resolve(ComputedWhenRead(state, RESULTS))
    return state


def test_each_measure_has_a_view_and_all_have_one_scale(state, rig, binding):
    scene = resolve(state)
    assert scene.views == ("Straight line", "Along voxels, R = 16", "Any angle, R = 16")
    bodies = [scene.actors[name] for name in ("body", "body 1", "body 2")]
    assert [body.view for body in bodies] == [0, 1, 2]
    assert len({body.limits for body in bodies}) == 1
    method = cutcell.ANIMATION.with_options(resolution=16)
    for name, body in zip(("straight", "voxel", "any"), bodies, strict=True):
        result = measure_distance(rig, binding.distances, 1, name, method).vertices
        np.testing.assert_allclose(body.scalars, result, rtol=1e-5)
        assert result.max() <= farthest(state) == body.limits[1]
    assert scene.actors["voxels"].view == 1
    assert not wants_field(state)  # of the single view


def test_beside_the_converged_one_each_says_its_error(state):
    state.param.update(beside_straight=False, beside_voxel=False, beside_converged=True)
    resolve(ComputedWhenRead(state, RESULTS))
    one, converged = (state.measured[name] for name in ("any", "converged"))
    error = mean_error(one, converged)
    assert 0 < error < 0.1
    assert resolve(state).views[0] == f"Any angle, R = 16 · error {error:.1%}"
    assert mean_error(converged, converged) == 0


def test_from_a_clicked_vertex_each_draws_its_path(state):
    state.vertex = 0
    scene = resolve(state)
    for view, name in enumerate(state.measures):
        assert scene.actors[f"path {view}"].view == view
        distance = state.measured[name].vertices[0] * longest_side(state.rig)
        assert scene.views[view].endswith(f" · {distance:.3g} units"), "as coloured and exported"
    state.path = False
    assert "path 0" not in resolve(state).actors


def test_a_distance_is_one_number_in_caption_legend_and_card(rig, binding):
    """The path that is drawn may be shorter or longer by a cell."""
    state = PageState(rig=rig, binding=binding, joint=2, panel="distance", vertex=0)
    state.param.update(resolution=16, beside_resolution=16, beside_any=True)
    resolve(ComputedWhenRead(state, RESULTS))
    (caption,) = resolve(state).views
    state.beside_any = False
    resolve(ComputedWhenRead(state, RESULTS))
    (text,) = (text for _, text in resolve(state).legend.swatches if text.startswith("shortest"))
    facts = vertex_facts(state)
    (row,) = (one for one in facts["distances"] if one["joint"] == 2)
    exported = binding.distances.joint[2, 0] * longest_side(rig)
    for one in (caption, text, f"{row['distance']:.3g} {facts['unit']}"):
        assert one.endswith(f"{exported:.3g} units")


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_views_side_by_side_keep_a_scale_that_is_chosen(state, scale):
    state.scale_end = scale
    assert {resolve(state).actors[name].limits for name in ("body", "body 1")} == {(0.0, scale)}


def test_waves_are_in_step(state):
    state.param.update(wave=True, front=0.5)
    scene = resolve(state)
    assert scene.front == 0.5 * farthest(state)
    following = [
        scene.actors[name].follows_wavefront for name in ("body", "body 1", "body 2", "voxels")
    ]
    assert all(following)
    assert (BODY, "not reached yet") in scene.legend.swatches


def test_what_is_not_measured_yet_waits(state):
    state.param.update(measured={}, computing=frozenset({("measured", "voxel")}))
    scene = resolve(state)
    assert scene.views[:2] == ("Straight line · waiting", "Along voxels, R = 16 · computing")
    assert scene.actors["body"].opacity == WAITING
    assert farthest(state) is None


def test_what_was_measured_of_something_else_is_not_shown(session, loop):
    state = session.state
    state.param.update(resolution=16, beside_resolution=16)
    loading.show_rig(session, arm_rig())
    state.param.update(panel="distance", joint=1, beside_straight=True, beside_6=True)
    loop.run_until(lambda: len(state.measured) == 2, 60)
    state.beside_resolution = 32
    assert set(state.measured) == {"straight"}, "its distances have no resolution"
    state.joint = 2
    assert state.measured == {}


def test_there_is_no_cut_through_bodies_side_by_side(state):
    state.cut_axis = "z"
    assert resolve(state).cut is None
    state.param.update(beside_straight=False, beside_voxel=False, beside_any=False)
    assert resolve(state).cut is not None
    assert wants_field(state)


def test_all_bodies_move(state, rig):
    moving = following(state)
    assert [name for name in moving.actors if name.startswith("body")] == [
        "body", "body 1", "body 2"
    ]  # fmt: skip
    assert all(actor.skin is not None for actor in moving.actors.values())


def test_four_at_most_and_the_address_knows_them(state, rig):
    assert set(NAMED) == set(MEASURES)
    state.param.update(beside_6=True, beside_26=True, beside_surface=True)
    assert len(state.measures) == 4
    choices = from_query(to_query(state), PageState())[0]
    assert choices["beside_26"] is True
    assert choices["beside_resolution"] == 16


def test_they_are_computed_one_after_the_other(session, loop):
    state = session.state
    state.param.update(resolution=16, beside_resolution=16)
    loading.show_rig(session, arm_rig())
    state.param.update(panel="distance", beside_surface=True, beside_6=True)
    loop.run_until(lambda: len(state.measured) == 2, 60)
    loop.run_until(lambda: not state.computing)
    assert state.field is None
    assert all(state.measured[name] is not None for name in state.measures)


def test_one_that_fails_is_told_and_taken_off(session, loop, monkeypatch):
    def fails(rig, distances, joint, name, method):
        if name == "6":
            raise cutcell.errors.MeshError("the mesh is too large")
        return measure_distance(rig, distances, joint, name, method)

    monkeypatch.setattr("cutcell_app.features.distance.results.measure_distance", fails)
    state = session.state
    state.param.update(resolution=16, beside_resolution=16)
    loading.show_rig(session, arm_rig())
    state.param.update(panel="distance", beside_6=True, beside_straight=True)
    loop.run_until(lambda: "straight" in state.measured and not state.computing, 60)
    assert state.measures == ["straight"]
    assert state.message == ("error", "The mesh is too large.")
