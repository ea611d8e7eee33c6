"""The laboratory of the panel Compare: sweeps, their curves and tables, and settings to choose."""

import csv

import numpy as np
import pytest

import cutcell
import cutcell_lab
from cutcell.editing import Edits, Filled, Layer
from cutcell.runtime.progress import silent
from cutcell_app.document import loading
from cutcell_app.document.address import to_query
from cutcell_app.editing.correct import commands as correct
from cutcell_app.features.compare.lab import results as lab
from cutcell_app.features.compare.lab.choices import OPTIONS, VALUES
from cutcell_app.features.compare.lab.controls import FIELDS, SWEEP, about, plots, table
from cutcell_app.features.compare.lab.curves import plot
from cutcell_app.features.compare.lab.rows import Setting, in_units, number, settings_of
from cutcell_app.looks.measures import CONVERGED, RESOLUTIONS
from cutcell_app.shell.session import keys
from cutcell_app.widgets.controls import draw
from cutcell_app.widgets.curves import Curves
from cutcell_lab.baselines.measured_distance import error_points
from cutcell_lab.sweeps import MEASURES
from tests.app.loop import settled
from tests.viewers.arm import arm_rig


def swept(session, loop, option, values=""):
    """Run a sweep to its end; return its points by the text of their value."""
    lab.choose_option(session, option)
    lab.choose_values(session, values)
    lab.start(session)
    assert session.state.sweeping
    loop.run_until(lambda: not session.state.sweeping)
    return session.state.swept


def saved(session):
    """Return the name of the CSV that is handed over, its settings, and its rows."""
    files = []
    session.view.offer = lambda *file: files.append(file)
    lab.export(session)
    ((name, content),) = files
    lines = content.decode().splitlines()
    about = [line for line in lines if line.startswith("#")]
    return name, about, list(csv.DictReader(lines[len(about) :]))


@pytest.mark.parametrize(
    ("option", "values"), [("resolution", "8, 12"), ("winding_threshold", "0.3,0.6")]
)
def test_the_page_has_the_numbers_of_the_core(bound, loop, option, values):
    rig = bound.state.rig
    points = swept(bound, loop, option, values)
    core = cutcell_lab.sweep(rig, option, [p.value for p in points.values()], resolution=16)
    for point, expected in zip(points.values(), core.points, strict=True):
        for name in MEASURES:
            if name != "seconds":
                assert getattr(point, name) == getattr(expected, name)
    rows = table(bound.state)["rows"]
    for row, expected in zip(rows, core.points, strict=True):
        numbers = [number(in_units(name, getattr(expected, name))) for name in FIELDS]
        assert row["values"][:-1] == numbers[:-1]
    name, settings, lines = saved(bound)
    assert name == f"arm-{option}.csv"
    assert "# reference: file" in settings
    assert [float(one["l1"]) for one in lines] == [point.l1 for point in core.points]


@pytest.mark.parametrize("option", OPTIONS.values())
def test_each_option_has_values_that_can_be_chosen(bound, loop, option):
    state = bound.state
    lab.choose_option(bound, option)
    assert state.sweep_texts == VALUES[option].split(",")
    for setting in settings_of(state):
        lab.choose(bound, setting.choices)
        assert state.message is None
        assert {name: getattr(state, name) for name in setting.choices} == setting.choices


def test_results_come_one_by_one_and_stay_when_it_is_stopped(bound, loop):
    lab.choose_values(bound, "8,10,12,14")
    lab.start(bound)
    loop.run_until(lambda: len(bound.state.swept) == 2)
    lab.stop(bound)
    loop.rest(bound)
    rows = table(bound.state)["rows"]
    assert [bool(row["values"][0]) for row in rows] == [True, True, False, False]
    lab.start(bound)
    loop.run_until(lambda: not bound.state.sweeping)
    assert len(bound.state.swept) == 4


def test_a_setting_that_fails_says_why(bound, loop):
    points = swept(bound, loop, "resolution", "8,1,many,12")
    assert [bool(point.failed) for point in points.values()] == [False, True, True, False]
    rows = table(bound.state)["rows"]
    assert rows[1]["state"] == "failed"
    assert rows[1]["note"].startswith("Resolution must be")
    assert rows[1]["fixed"]
    assert bound.state.message is None
    assert saved(bound)[2][1]["failed"] == points["1"].failed


def test_a_point_becomes_the_choice_of_the_page_and_is_undone(bound, loop):
    swept(bound, loop, "resolution", "8,12")
    before = dict(bound.state.swept)
    lab.choose(bound, settings_of(bound.state)[1].choices)
    settled(bound, loop)
    assert bound.state.binding.method.resolution == 12
    assert bound.state.swept == before, "the sweep does not depend on the value that is chosen"
    assert [row["chosen"] for row in table(bound.state)["rows"]] == [False, True]
    keys.act(bound, "undo")
    assert bound.state.resolution == 16
    lab.choose(bound, {"max_influences": None})
    assert "does not offer max_influences=None" in bound.state.message[1]
    assert bound.state.max_influences == 4


def test_alpha_belongs_to_the_papers_falloff(bound, loop):
    points = swept(bound, loop, "alpha", "0,1")
    core = cutcell_lab.sweep(
        bound.state.rig, "alpha", [0, 1], resolution=16, falloff="paper", leaf="fit"
    )
    assert [p.l1 for p in points.values()] == [p.l1 for p in core.points]
    lab.choose(bound, settings_of(bound.state)[0].choices)
    assert (bound.state.falloff, bound.state.alpha) == ("paper", 0)


def test_other_options_end_what_was_swept(bound, loop):
    swept(bound, loop, "resolution", "8,12")
    bound.state.alpha = 0.2  # it has no effect with this falloff
    assert len(bound.state.swept) == 2
    bound.state.winding_threshold = 0.4
    assert bound.state.swept == {}
    assert not bound.state.sweeping


def test_without_weights_of_the_file_the_default_is_the_reference(session, loop):
    session.state.resolution = 16
    loading.show_rig(session, arm_rig().with_weights(None))
    loop.run_until(lambda: session.state.binding is not None)
    points = swept(session, loop, "threshold", "0,0.3")
    assert points["0"].l1 == 0 < points["0.3"].l1
    assert "no weights" in about(session.state)
    assert "# reference: computed" in saved(session)[1]


def test_values_are_checked(bound):
    lab.choose_values(bound, " , ")
    assert "commas" in bound.state.message[1]
    assert bound.state.sweep_values == ""
    lab.choose_values(bound, ",".join(map(str, range(2, 40))))
    assert "at most 20" in bound.state.message[1]
    lab.choose_values(bound, "8,8, 12")
    assert bound.state.sweep_texts == ["8", "12"]


def points_of(plot):
    """Return all points of a plot."""
    return [point for curve in plot["curves"] for point in curve["points"]]


def test_curves_have_a_point_for_each_value(bound, loop):
    swept(bound, loop, "connectivity", "6,26,1,any")
    ((plot),) = plots(bound.state)
    points, measured = points_of(plot), [p for p in bound.state.swept.values() if not p.failed]
    assert [point["title"] for point in points] == ["6 axes", "26 diagonals", "Any angle"]
    assert [point["text"] for point in points] == [number(one.l1) for one in measured]
    assert [point["chosen"] for point in points] == [False, False, True]
    assert [point["at"][0] for point in points] == [0, 0.5, 1]
    by_height = sorted(points, key=lambda point: point["at"][1])
    assert [p["text"] for p in by_height] == [number(x) for x in sorted(p.l1 for p in measured)]
    widget = draw(bound, SWEEP).select(Curves)[0]
    assert widget.plots == [plot]
    widget._handle_msg({"type": "pick-point", "id": "26"})
    assert bound.state.connectivity == 26
    widget._handle_msg({"type": "pick-point", "id": "27"})
    assert bound.state.connectivity == 26


def test_axes_end_at_round_numbers():
    def marks(values, **options):
        settings = [
            Setting(str(k), str(k), {"n": k}, values={"l1": value})
            for k, value in enumerate(values)
        ]
        drawn = plot(settings, "l1", "L1", lambda setting: False, **options)
        assert all(0 <= place <= 1 for point in points_of(drawn) for place in point["at"])
        return [text for _, text in drawn["y_ticks"]]

    assert marks([0.486, 0.622]) == ["0.45", "0.5", "0.55", "0.6", "0.65"]
    assert marks([0.0, 0.0]) == ["0", "0.5"]
    assert marks([3.0]) == ["3", "4"]
    assert marks([0, 3000, 1], x="n") == ["0", "1000", "2000", "3000"]
    assert marks([0.04, 20], logarithmic=True) == ["0.01", "0.1", "1", "10", "100"]


def test_errors_of_distances_are_less_at_a_higher_resolution(bound, loop):
    state = bound.state
    state.param.update(sweep_of="distance", joint=1)
    before = to_query(state)
    lab.start(bound)
    assert to_query(state) == before
    loop.run_until(lambda: state.error_curves is not None)
    assert not state.measuring_errors
    method = cutcell.ANIMATION.with_options(resolution=CONVERGED)
    points = error_points(state.rig, state.binding.distances, 1, method, RESOLUTIONS, silent)
    settings = settings_of(state)
    errors = [100 * point.error for point in points]
    assert [one.values["error"] for one in settings] == errors
    finest = {one.choices["connectivity"]: one.values["error"] for one in settings}
    coarsest = {one.choices["connectivity"]: one.values["error"] for one in settings[::-1]}
    assert finest["any"] < coarsest["any"]
    error, seconds = plots(bound.state)
    assert [curve["name"] for curve in error["curves"]][-1] == "Any angle"
    assert [len(curve["points"]) for curve in seconds["curves"]] == [len(RESOLUTIONS)] * 3
    name, _, lines = saved(bound)
    assert name == "arm-distance.csv"
    np.testing.assert_array_equal([float(one["error"]) for one in lines], [p.error for p in points])
    lab.choose(bound, settings[0].choices)
    assert (state.connectivity, state.resolution) == (6, RESOLUTIONS[0])
    settled(bound, loop)
    assert state.binding.graph.connectivity == 6
    assert [one.values["error"] for one in settings_of(state)] == errors, "they stay"


def test_a_setting_is_seen_over_the_computed_base(bound, loop):
    state = bound.state
    correct.choose_file(bound, True)
    settled(bound, loop)
    lab.choose(bound, {"max_influences": 1})
    assert state.edits.base == "computed"
    assert "base" in state.message[1]
    loop.rest(bound)
    assert ((state.binding.weights > 0).sum(axis=1) == 1).all()
    state.message = None
    lab.choose(bound, {"max_influences": 2})
    assert state.message is None
    keys.act(bound, "undo")
    keys.act(bound, "undo")
    assert (state.edits.base, state.max_influences) == ("file", 4)


def test_layers_are_left_out(bound, loop):
    before = swept(bound, loop, "resolution", "8")["8"]
    name = bound.state.rig.skeleton.names[0]
    correct.correct(bound, Edits(layers=[Layer(Filled({name: 1}))]))
    settled(bound, loop)
    assert "Layers are left out" in about(bound.state)
    assert swept(bound, loop, "resolution", "8,9")["8"].l1 == before.l1
