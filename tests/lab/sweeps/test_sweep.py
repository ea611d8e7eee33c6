"""Sweeps: every number is that of the core, and nothing is computed twice for nothing."""

import csv
import json

import numpy as np
import pytest

import cutcell
import cutcell_lab
from cutcell.errors import Cancelled, ParameterError
from cutcell_lab.metrics import deformation_error, precision_recall, vertex_shares, weight_l1
from cutcell_lab.sweeps import MEASURES, OPTIONS, bind_setting, parsed_values, run
from tests.viewers.arm import arm_rig

SWEPT = {
    "resolution": (8, 16),
    "winding_threshold": (0.3, 0.7),
    "connectivity": (6, "any"),
    "orient": (True, False),
    "samples": (1, 5),
    "leaf": ("point", "fit"),
    "falloff": ("rig", "paper"),
    "alpha": (0.0, 0.9),
    "max_influences": (1, None),
    "threshold": (0.0, 0.2),
}


@pytest.fixture(scope="module")
def rig():
    return arm_rig()


@pytest.mark.parametrize("option", OPTIONS)
def test_each_setting_has_the_numbers_of_a_binding_of_its_own(rig, option):
    method = cutcell.PAPER if option == "alpha" else cutcell.ANIMATION
    sweep = cutcell_lab.sweep(rig, option, SWEPT[option], method=method, resolution=12)
    share = vertex_shares(rig.mesh)
    assert (sweep.reference, len(sweep.points)) == ("file", 2)
    for point, value in zip(sweep.points, SWEPT[option], strict=True):
        setting = method.with_options(**{"resolution": 12, option: value})
        binding = cutcell.bind(rig, setting.resolution, method=setting)
        assert (point.value, point.failed) == (value, "")
        assert point.l1 == weight_l1(binding.weights, rig.weights, share)
        precision, recall = precision_recall(binding.weights, rig.weights, share)
        assert (point.precision, point.recall) == (precision, recall)
        assert point.deformation == deformation_error(rig, binding.weights, rig.weights).mean
        assert point.unreachable == share @ (binding.distances.fallback > 0)
        assert point.seconds > 0


@pytest.mark.parametrize(
    ("option", "graphs", "distances"),
    [("resolution", 2, 2), ("leaf", 1, 2), ("falloff", 1, 2), ("alpha", 1, 1), ("threshold", 1, 1)],
)
def test_what_an_option_does_not_change_is_reused(rig, option, graphs, distances):
    method = cutcell.PAPER if option == "alpha" else cutcell.ANIMATION
    binding, bindings = None, []
    for value in SWEPT[option]:
        setting = method.with_options(**{"resolution": 12, option: value})
        binding = bind_setting(rig, setting, binding)
        bindings.append(binding)
        assert binding.method == setting
        fresh = cutcell.bind(rig, setting.resolution, method=setting)
        np.testing.assert_array_equal(binding.weights, fresh.weights)
        assert set(binding.seconds) >= {"graph", "distances", "weights"}
    assert len({id(one.graph) for one in bindings}) == graphs
    assert len({id(one.distances) for one in bindings}) == distances


def test_a_binding_of_another_rig_is_not_reused(rig):
    method = cutcell.ANIMATION.with_options(resolution=12)
    earlier = bind_setting(rig, method)
    moved = rig.with_joints(np.add(rig.skeleton.joints, [0.01, 0, 0]))
    again = bind_setting(moved, method, earlier)
    assert again.graph is earlier.graph
    np.testing.assert_array_equal(again.weights, cutcell.bind(moved, 12).weights)


def test_without_weights_of_the_file_the_method_itself_is_the_reference(rig):
    sweep = cutcell_lab.sweep(rig.with_weights(None), "threshold", [0.0, 0.4], resolution=12)
    assert sweep.reference == "computed"
    assert (sweep.points[0].l1, sweep.points[0].deformation) == (0, 0)
    assert sweep.points[1].l1 > 0


def test_a_setting_that_fails_is_listed_and_stops_no_other(rig):
    sweep = cutcell_lab.sweep(rig, "resolution", [12, 1, "many", 16])
    assert [bool(point.failed) for point in sweep.points] == [False, True, True, False]
    assert "resolution must be" in sweep.points[1].failed
    assert all(getattr(sweep.points[1], name) is None for name in MEASURES)
    with pytest.raises(ParameterError, match="alphas"):
        cutcell_lab.sweep(rig, "alphas", [1])
    (point,) = cutcell_lab.sweep(rig, "alpha", [0.5], resolution=12).points
    assert "has no effect with falloff='rig'" in point.failed


def test_a_sweep_is_cancelled_by_its_progress(rig):
    def stop(stage, fraction):
        if stage == "16":
            raise Cancelled

    with pytest.raises(Cancelled):
        cutcell_lab.sweep(rig, "resolution", [8, 16], progress=stop)


def test_tables_hold_the_numbers_to_the_bit(rig):
    sweep = cutcell_lab.sweep(rig, "orient", [True, "maybe"], resolution=12)
    lines = sweep.to_csv().splitlines()
    about = [line for line in lines if line.startswith("#")]
    assert {"# reference: file", "# resolution: 12"} <= set(about)
    good, bad = csv.DictReader(lines[len(about) :])
    assert (good["orient"], bad["orient"]) == ("yes", "maybe")
    assert [float(good[name]) for name in MEASURES] == [
        getattr(sweep.points[0], name) for name in MEASURES
    ]
    assert (bad["l1"], good["failed"]) == ("", "")
    assert "orient" in bad["failed"]
    assert json.loads(json.dumps(sweep.to_dict()))["points"][0]["l1"] == sweep.points[0].l1


def test_values_are_typed_with_commas():
    assert parsed_values("32, 0.5,any,,all,No") == [32, 0.5, "any", None, False]
    assert parsed_values("1e400")[0] == float("inf")
    with pytest.raises(ParameterError, match="commas"):
        parsed_values(" , ")
    texts = [run.value_text(value) for value in (32, 0.5, "any", None, False)]
    assert parsed_values(",".join(texts)) == [32, 0.5, "any", None, False]
