"""The cutting plane: dragged by its handles, turned towards the eye, told to the view."""

import numpy as np
import pytest

from cutcell_app.document.framing import bounds_of
from cutcell_app.looks import cut as cutting
from cutcell_app.looks.character import cut_of
from cutcell_viewers.camera import Camera


def test_a_plane_that_is_dragged_lies_where_it_was_left(bound):
    bound.state.param.update(panel="distance", cut_axis="x")
    cut = cut_of(bound.state)
    low, high = bounds_of(bound.state)
    there = low + 0.25 * (high - low)
    cutting.put(bound, there, cut.normal)
    assert bound.state.cut_axis == "x"
    assert bound.state.cut_position == pytest.approx(0.25)
    cutting.put(bound, low - 5.0, cut.normal)
    assert bound.state.cut_position == 0.0


def test_a_plane_that_is_turned_becomes_free(bound):
    bound.state.param.update(panel="distance", cut_axis="z")
    out = np.array([0.36, 0.48, 0.8])
    there = bounds_of(bound.state).mean(axis=0) + 0.2 * out
    cutting.put(bound, there, 3 * out)
    assert bound.state.cut_axis == "free"
    cut = cut_of(bound.state)
    np.testing.assert_allclose(cut.normal, out, atol=1e-3)
    assert (there - cut.origin) @ cut.normal == pytest.approx(0, abs=1e-2)
    before = bound.state.cut_yaw
    cutting.put(bound, there, [0.0, 0.0, 0.0])
    cutting.put(bound, there, [float("nan"), 0.0, 1.0])
    assert bound.state.cut_yaw == before


def test_a_plane_faces_the_eye(bound):
    bound.state.param.update(panel="graph", cut_axis="x")
    cutting.face_the_eye(bound)  # nobody looks yet
    bound.view.camera = Camera((0.0, 3.0, 4.0), (0.0, 0.0, 0.0))
    cutting.face_the_eye(bound)
    np.testing.assert_allclose(cut_of(bound.state).normal, [0, 0.6, 0.8], atol=1e-3)


def test_the_handles_are_there_while_there_is_a_plane(bound, loop):
    state = bound.state
    assert bound.view.last_sent("handles") is None
    state.param.update(panel="graph", cut_axis="y")
    loop.rest(bound)
    np.testing.assert_allclose(bound.view.last_sent("handles")["box"], bounds_of(state))
    state.slicing = True
    loop.rest(bound)
    assert bound.view.last_sent("handles") is None
    state.param.update(panel="distance")
    loop.rest(bound)
    assert bound.view.last_sent("handles") is not None
    state.panel = "weights"
    assert bound.view.last_sent("handles") is None


def test_the_box_of_the_body_is_measured_once(bound):
    assert bounds_of(bound.state) is bounds_of(bound.state)
