"""The flat scene, sliders in sentences and small plots, without a browser."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array

from cutcell_app.document.address import from_query, to_query
from cutcell_app.document.look import pick_vertex
from cutcell_app.features.flat.choices import MODES
from cutcell_app.features.learn.plots import plot_of
from cutcell_app.features.learn.sliders import SLIDERS, slide, sliders_of
from cutcell_app.features.state import PageState
from cutcell_lab.baselines.measured_distance import ErrorPoint
from cutcell_viewers.distance_scene import longest_side


def shown(session, loop):
    loop.rest(session)
    return json.loads(session.state.flat_data)


def test_nothing_is_computed_until_a_mode_is_chosen(bound, loop):
    loop.rest(bound)
    assert bound.state.flat_data is None
    bound.state.flat = "rays"
    assert shown(bound, loop)["rays"]


def test_the_data_follow_the_bone_the_plane_and_the_method(bound, loop):
    bound.state.param.update(flat="search", joint=1)
    first = shown(bound, loop)
    assert first["bone"] == "elbow"
    assert first["sources"]
    assert first["resolution"] == 40
    bound.state.joint = 2
    assert shown(bound, loop)["sources"] != first["sources"]
    bound.state.slice_axis = "x"
    assert shown(bound, loop)["frame"] != first["frame"]
    bound.state.param.update(graph_resolution=12, winding_threshold=0.25)
    changed = shown(bound, loop)
    assert (changed["resolution"], changed["tau"]) == (12, 0.25)


def test_a_mesh_without_a_skeleton_has_no_sources(bare, loop):
    bare.state.flat = "search"
    assert shown(bare, loop)["sources"] == []


@pytest.mark.parametrize("mode", MODES.values())
def test_the_address_names_the_mode(mode):
    state = PageState(flat=mode)
    query = to_query(state)
    assert ("flat=" in query) == bool(mode)
    assert from_query(query, state)[0].get("flat", "") == mode


def test_an_address_with_an_unknown_mode_is_reported():
    assert from_query("?flat=tree", PageState())[2] == ["flat=tree"]


def test_a_text_names_its_sliders():
    state = PageState(alpha=0.25)
    sliders = sliders_of(state, "Drag α to {alpha} at {graph_resolution}, not {panel}.")
    assert list(sliders) == ["alpha", "graph_resolution"]
    assert sliders["alpha"]["value"] == 0.25
    assert [0.25, "0.25"] in json.loads(json.dumps(sliders["alpha"]["stops"]))


@pytest.mark.parametrize("name", SLIDERS)
def test_each_stop_can_be_chosen_and_nothing_else(session, name):
    for value, _ in SLIDERS[name][1]:
        slide(session, name, value)
        assert getattr(session.state, name) == value
    for other in (-1, "none", None, [1]):
        slide(session, name, other)
        assert getattr(session.state, name) == value
    slide(session, "panel", "graph")
    assert session.state.panel != "graph"


def test_the_weights_of_a_vertex_lie_on_the_paper_s_curve(bound, loop):
    bound.state.param.update(falloff="paper", alpha=0.3, joint=1, max_influences=3, threshold=0)
    loop.rest(bound)
    assert plot_of(bound.state, "falloff") is None
    pick_vertex(bound, 7)
    plot = json.loads(json.dumps(plot_of(bound.state, "falloff")))
    (d, one), *_ = plot["curve"]["points"]
    assert one == 1
    diagonal = bound.state.binding.graph.lattice.diagonal * longest_side(bound.state.rig)

    def kernel(distance):
        x = distance / diagonal
        return (0.7 * x + 0.3 * x**2) ** -2.0

    for distance, weight in [plot["twice"], *(mark["at"] for mark in plot["marks"])]:
        assert weight == pytest.approx(kernel(distance) / kernel(d))
    assert plot["twice"][0] == 2 * d
    assert len(plot["marks"]) == 3
    assert [mark["chosen"] for mark in plot["marks"]].count(True) == 1


def test_a_vertex_that_nothing_moves_has_no_plot(bound):
    pick_vertex(bound, 7)
    binding = bound.state.binding
    weights = binding.weights * (np.arange(len(binding.weights)) != 7)[:, None]
    bound.state.binding = replace(binding, rows=csr_array(weights))
    assert plot_of(bound.state, "falloff") is None


def test_errors_are_a_curve_for_each_connectivity(bound):
    assert plot_of(bound.state, "error") is None
    bound.state.error_curves = [
        ErrorPoint(measure, n, 1 / n, 0.1) for measure in ("6", "any") for n in (16, 32)
    ]
    plot = plot_of(bound.state, "error")
    assert plot["at"] == 16
    assert [len(curve["points"]) for curve in plot["curves"]] == [2, 2]
    assert plot["curves"][1] == {"name": "Any angle", "points": [[16, 6.25], [32, 3.125]]}
