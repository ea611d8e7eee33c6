"""Settings side by side on the panel Compare: two R, or any two of the method's options."""

import numpy as np
import pytest

import cutcell
from cutcell.errors import ParameterError
from cutcell_app.document.address import from_query, to_query
from cutcell_app.document.side_by_side import (
    NOW,
    is_settings,
    listed,
    name_of,
    settings,
    title_of_settings,
)
from cutcell_app.features.compare import results as compare
from cutcell_app.features.compare.controls import rows_of
from cutcell_app.features.compare.scene import round_top
from cutcell_app.features.scenes import resolve
from cutcell_app.headless.choices import Choices
from cutcell_app.headless.scene import describe
from cutcell_lab.metrics import vertex_shares, weight_l1
from tests.app.loop import settled
from tests.viewers.arm import arm_rig

METHODS = [
    cutcell.ANIMATION,
    cutcell.PAPER,
    cutcell.Method(resolution=12, winding_threshold=0.3, orient=False, leaf="extend"),
    cutcell.Method(falloff="paper", alpha=0.25, connectivity=26, max_influences=2, threshold=0.01),
]


def added(session, option, value):
    """Add settings, and return their name."""
    before = set(session.state.methods)
    session.state.param.update(added_option=option, added_value=value)
    compare.add(session)
    return next(iter(set(session.state.methods) - before), None)


@pytest.fixture
def page(bound):
    bound.state.param.update(panel="compare", methods=[NOW, "artist"], joint=1)
    return bound


@pytest.mark.parametrize("method", METHODS)
def test_a_name_contains_all_options(method):
    assert settings(name_of(method)) == method
    assert "," not in name_of(method)
    assert title_of_settings(name_of(method)).startswith(f"R = {method.resolution}")


def test_titles_name_what_differs():
    titles = [title_of_settings(name_of(method)) for method in METHODS]
    assert titles[:2] == ["R = 64", "R = 64, paper"]
    assert titles[2] == "R = 12, τ = 0.3, flipped faces: no, bones: extend"
    assert titles[3] == "R = 64, paper falloff, 26 axes, α = 0.25, 2 influences, from 0.01"
    assert title_of_settings("@connectivity=6;method=animation") == "R = 64, 6 axes"


@pytest.mark.parametrize(
    "name", ["now", "@resolution=1", "@resolution=a", "@x=1", "@resolution=8,9", "@alpha=0.5", "@="]
)
def test_other_names_are_refused(name):
    assert not is_settings(name)
    with pytest.raises(ParameterError, match="no settings"):
        settings(name)


def test_two_resolutions_stand_side_by_side_with_their_difference(page, loop):
    state = page.state
    name = added(page, "resolution", "10")
    assert state.methods == [NOW, "artist", name]
    compare.choose(page, "artist", False)
    settled(page, loop)
    one = state.compared[name]
    expected = cutcell.bind(state.rig, 10)
    np.testing.assert_array_equal(one.weights, expected.weights)
    assert one.l1 == weight_l1(expected.weights, state.rig.weights, vertex_shares(state.rig.mesh))
    row = next(row for row in rows_of(state) if row["id"] == name)
    assert (row["title"], row["chosen"]) == ("R = 10", True)
    assert resolve(state).views == ("Current weights", "R = 10")
    state.minus = NOW
    scene = resolve(state)
    assert scene.views[1] == "R = 10 − Current weights"
    difference = expected.weights[:, 1] - state.binding.weights[:, 1]
    body = scene.actors["body 1"]
    np.testing.assert_allclose(body.scalars, difference, atol=1e-6)
    top = round_top(np.abs(difference).max())
    assert body.limits == scene.actors["body"].limits == (-top, top)
    assert scene.legend.high == f"+{top:g}"
    state.compare_field = "all"
    assert resolve(state).legend.high.endswith("%")


def test_settings_do_not_follow_the_page(page, loop):
    name = added(page, "", "")
    settled(page, loop)
    before = page.state.compared[name]
    page.state.winding_threshold = 0.3
    loop.rest(page)
    assert page.state.compared[name] is before
    assert settings(name).winding_threshold == 0.5
    compare.choose(page, name, False)
    assert name not in listed(page.state.rig, page.state.methods)


def test_what_cannot_be_added_is_told(page):
    assert added(page, "resolution", "") is None
    assert "values must be separated" in page.state.message[1].lower()
    assert added(page, "resolution", "8,9") is None
    assert added(page, "winding_threshold", "2") is None
    assert "winding_threshold" in page.state.message[1]
    assert added(page, "alpha", "0.25")
    assert added(page, "alpha", "0.25") is None
    assert "already" in page.state.message[1]


def test_a_setting_that_cannot_be_bound_says_why(page, loop, monkeypatch):
    def fails(*arguments):
        raise cutcell.TooLargeError("too large")

    monkeypatch.setattr(compare, "bind_setting", fails)
    name = added(page, "resolution", "20")
    loop.rest(page)
    assert page.state.compared[name].failed == "too large"


def test_settings_are_part_of_the_address(page):
    name = added(page, "winding_threshold", "0.25")
    query = to_query(page.state)
    assert from_query(query, page.state)[1]["methods"] == [NOW, "artist", name]
    _, arrival, problems = from_query("methods=now,%40resolution%3D1", page.state)
    assert ("methods" in arrival, len(problems)) == (False, 1)


def test_scales_of_differences_are_round():
    assert [round_top(x) for x in (0, 0.011, 0.05, 0.3, 0.51, 1)] == [0.01, 0.02, 0.05, 0.5, 1, 1]


def test_a_picture_shows_two_settings():
    method = cutcell.ANIMATION.with_options(resolution=8)
    names = ("@resolution=8", "@resolution=12")
    scene = describe(arm_rig(), Choices("compare", methods=names, method=method))
    assert scene.views == ("R = 8", "R = 12")
    with pytest.raises(ParameterError, match="method must be one of"):
        describe(arm_rig(), Choices("compare", methods=("@resolution=1",), method=method))
