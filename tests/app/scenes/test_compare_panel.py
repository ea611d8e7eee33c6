"""The panel Compare, from state to scene and to its table."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
import cutcell_lab
from cutcell.runtime.progress import silent
from cutcell_app.derive.engine import Engine
from cutcell_app.derive.work import Work
from cutcell_app.document.side_by_side import NOW, offered
from cutcell_app.features.compare.controls import FIELD, about, rows_of
from cutcell_app.features.compare.results import Compared, choose, measured
from cutcell_app.features.compare.scene import WAITING, caption_of, field_shown
from cutcell_app.features.learn.lesson import Answer, Lesson, Step
from cutcell_app.features.scenes import resolve
from cutcell_app.features.state import PageState
from cutcell_app.looks.methods import title_of
from cutcell_app.widgets.controls import draw
from cutcell_lab.baselines import METHODS, BaselineBinding
from cutcell_lab.metrics import deformation_error, weight_l1


@pytest.fixture(scope="module")
def euclidean(rig, binding):
    return measured(rig, "euclidean", binding, 16, silent)


@pytest.fixture
def state(rig, binding, euclidean):
    return PageState(
        rig=rig, binding=binding, joint=1, panel="compare", methods=[NOW, "artist", "euclidean"],
        compared={"euclidean": euclidean},
    )  # fmt: skip


class Page:
    """As much of a session as choosing needs."""

    def __init__(self, state):
        self.state = state
        self.engine = Engine(state, Work(lambda action: action(), print))


def test_each_method_has_a_view_of_its_own_and_bones_stand_in_all(state, rig, euclidean):
    scene = resolve(state)
    assert scene.views == ("Current weights", "From file", "Euclidean")
    bodies = [scene.actors[name] for name in ("body", "body 1", "body 2")]
    assert [body.view for body in bodies] == [0, 1, 2]
    assert scene.actors["bones"].view is None
    np.testing.assert_allclose(bodies[1].scalars, rig.weights[:, 1], atol=1e-6)
    np.testing.assert_allclose(bodies[2].scalars, euclidean.weights[:, 1], atol=1e-6)
    assert bodies[1].points is bodies[0].points


def test_they_are_posed_by_their_own_weights(state):
    state.turns = {1: (0, 40, 0)}
    scene = resolve(state)
    assert scene.pose is not None
    own, other = scene.actors["body"].skin, scene.actors["body 1"].skin
    assert own.weights.shape != other.weights.shape or not np.array_equal(
        own.weights, other.weights
    )


def test_a_difference_is_taken_from_the_method_that_is_named(state, rig, euclidean):
    state.minus = "artist"
    scene = resolve(state)
    assert scene.views[1] == "From file − itself"
    assert scene.views[2] == "Euclidean − From file"
    expected = euclidean.weights[:, 1] - rig.weights[:, 1]
    np.testing.assert_allclose(scene.actors["body 2"].scalars, expected, atol=1e-6)
    assert scene.actors["body 1"].scalars.any() == False  # noqa: E712
    assert scene.legend.colormap == "difference"
    state.compare_field = "all"
    scene = resolve(state)
    share = np.abs(euclidean.weights - rig.weights).sum(axis=1) / 2
    np.testing.assert_allclose(scene.actors["body 2"].scalars, share, atol=1e-6)
    assert share.max() <= 1 + 1e-9


def test_a_step_of_a_lesson_gives_captions(state):
    state.lesson = Lesson(
        (Step("T", "Q", "panel=compare", Answer("choice"), captions={"euclidean": "B"}),)
    )
    state.param.update(step=0, minus="euclidean")
    assert resolve(state).views == (
        "Current weights − B",
        "From file − B",
        "B − itself",
    )


def test_errors_share_one_scale(state, rig, binding, euclidean):
    state.compared = {**state.compared, NOW: measured(rig, NOW, binding, 16, silent)}
    state.compare_field = "error"
    scene = resolve(state)
    one, other = scene.actors["body"], scene.actors["body 2"]
    lengths = 10 * np.sqrt(euclidean.errors.vertex)  # mm, of cm²
    assert one.limits == other.limits
    assert one.limits[1] >= np.quantile(lengths, 0.99)
    np.testing.assert_allclose(other.scalars, lengths, rtol=1e-6)
    for state.minus in ("", "artist"):  # which weights alone have
        mean = np.sqrt(euclidean.errors.mean) * 10
        assert resolve(state).views[2] == f"Euclidean · {mean:.0f} mm", "of these colours"
    assert scene.actors["body 1"].scalars is None  # the file's own was not measured yet


def test_what_is_not_there_yet_waits_pale_and_what_failed_says_so(state, rig):
    state.compared = {"euclidean": Compared(None, "it has no inside")}
    scene = resolve(state)
    assert scene.actors["body 2"].opacity == WAITING
    assert scene.views[2] == "Euclidean · failed"
    state.methods = [NOW, "voxel"]
    assert caption_of(state, "voxel").endswith("waiting")
    state.computing = frozenset({("compared", "voxel")})
    assert caption_of(state, "voxel").endswith("computing")


def test_nothing_is_compared_before_there_are_weights(state):
    state.binding = None
    assert resolve(state).views == ()


def test_the_measures_are_those_of_the_core(rig, euclidean):
    assert euclidean.deformation == deformation_error(rig, euclidean.weights, rig.weights).mean
    share = cutcell_lab.metrics.vertex_shares(rig.mesh)
    assert euclidean.l1 == weight_l1(euclidean.weights, rig.weights, share)
    assert euclidean.seconds > 0
    assert euclidean.unweighted == 0


def test_without_the_files_weights_only_times_are_measured(rig, binding):
    result = measured(rig.with_weights(None), "euclidean", binding, 16, silent)
    assert (result.l1, result.deformation, result.errors) == (None, None, None)
    assert result.seconds > 0
    assert "artist" not in offered(rig.with_weights(None))


def test_a_method_that_fails_says_why(rig, binding, monkeypatch):
    def gives_up(rig):
        return BaselineBinding(None, {"trying": 0.5}, failed="nothing is inside")

    def raises(rig):
        raise cutcell.errors.MeshError("the mesh is open")

    monkeypatch.setitem(METHODS, "gives_up", gives_up)
    monkeypatch.setitem(METHODS, "raises", raises)
    result = measured(rig, "gives_up", binding, 16, silent)
    assert (result.weights, result.failed, result.seconds) == (None, "nothing is inside", 0.5)
    assert measured(rig, "raises", binding, 16, silent).failed == "the mesh is open"
    assert {"gives_up", "raises"} <= set(offered(rig))
    assert title_of("gives_up") == "Gives up"


def test_two_to_four_methods_stay_chosen(state):
    page = Page(state)
    choose(page, "bone_heat", True)
    assert state.methods == [NOW, "artist", "bone_heat", "euclidean"]
    choose(page, "voxel", True)
    assert "voxel" not in state.methods
    state.minus = "euclidean"
    for name in ("bone_heat", "euclidean", "artist", NOW):
        choose(page, name, False)
    assert state.methods == [NOW, "artist"]
    assert state.minus == ""


def test_the_table_tells_what_is_known(state, rig):
    rows = {row["id"]: row for row in rows_of(state)}
    assert set(rows) == {NOW, *METHODS}
    assert rows["euclidean"]["values"][0] == f"{state.compared['euclidean'].l1:.2f}"
    assert rows["euclidean"]["best"][:2] == [True, True]
    assert rows["voxel"]["values"] == ["", "", ""]
    assert not rows["voxel"]["chosen"]
    assert rows[NOW]["note"] == "Waiting"
    state.methods = [NOW, "artist", "euclidean", "voxel"]
    state.compared = {"voxel": Compared(None, "no inside")}
    rows = {row["id"]: row for row in rows_of(state)}
    assert (rows["voxel"]["note"], rows["voxel"]["state"]) == ("No inside", "failed")
    assert rows["bbw"]["fixed"]
    assert not rows["voxel"]["fixed"]


def test_a_memo_keeps_what_did_not_change(state):
    before = resolve(state)
    state.turns = {1: (0, 10, 0)}
    after = resolve(state)
    for name, actor in before.actors.items():
        assert after.actors[name].skin is actor.skin, name
        assert after.actors[name].scalars is actor.scalars, name


def test_without_the_files_own_weights_no_error_is_promised(rig):
    assert about(PageState()) == about(PageState(rig=rig))
    assert about(PageState(rig=rig)).endswith("against the original weights.")
    assert "no weights" in about(PageState(rig=rig.with_weights(None)))


def test_without_weights_of_its_own_no_error_is_offered_or_shown(state, rig, binding):
    bare = replace(rig, weights=None)
    state.compare_field = "error"
    row = draw(Page(state), FIELD)
    assert "Error" in row.options
    state.param.update(rig=bare, binding=binding, methods=[NOW, "euclidean"], compared={})
    assert "Error" not in row.options
    assert row.value == field_shown(state) == "bone"
    assert resolve(state).legend.title == "Weight of " + rig.skeleton.names[1]
    state.rig = rig
    row.value = "error"
    assert field_shown(state) == "error"
