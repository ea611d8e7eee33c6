"""A method is checked once, has two presets, and refuses what would have no effect."""

from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest

from cutcell import ANIMATION, PAPER, Method, ParameterError, build_graph
from cutcell.method import Options, method_of
from tests import meshes


def test_the_presets_have_names():
    assert method_of("animation") is ANIMATION
    assert method_of("paper") is PAPER
    assert Method() == ANIMATION
    assert (PAPER.connectivity, PAPER.falloff, PAPER.leaf, PAPER.alpha) == (
        6,
        "paper",
        "point",
        0.5,
    )
    assert PAPER.max_influences is None
    assert ANIMATION.alpha is None


def test_single_options_go_on_top():
    method = method_of("paper", 128, alpha=0.25, samples=np.int64(3))
    assert (method.resolution, method.alpha, method.samples) == (128, 0.25, 3)
    assert type(method.samples) is int
    assert method.connectivity == 6
    assert method_of(method) is method
    assert method_of("animation", max_influences=None).max_influences is None


def test_leaf_and_alpha_follow_the_falloff_unless_they_are_given():
    soft = ANIMATION.with_options(falloff="paper")
    assert (soft.leaf, soft.alpha) == ("point", 0.5)
    sharp = PAPER.with_options(falloff="rig")
    assert (sharp.leaf, sharp.alpha) == ("fit", None)
    assert ANIMATION.with_options(falloff="paper", leaf="extend", alpha=1).leaf == "extend"
    # The same falloff again changes neither.
    assert PAPER.with_options(alpha=0.1).with_options(falloff="paper").alpha == 0.1


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"resolution": 1}, "resolution must be a whole number from 2 to 1,024, not 1"),
        ({"connectivity": 18}, "connectivity must be one of 6, 26, 'any', not 18"),
        ({"winding_threshold": 2}, "winding_threshold must be a number between 0 and 1, not 2"),
        ({"orient": "no"}, "orient must be True or False, not 'no'"),
        ({"samples": 0}, "samples must be a whole number from 1 to 1,000, not 0"),
        ({"leaf": "long"}, "leaf must be one of 'point', 'extend', 'fit', not 'long'"),
        ({"falloff": "soft"}, "falloff must be one of 'rig', 'paper', not 'soft'"),
        ({"falloff": "paper", "alpha": 2}, "alpha must be a number from 0 to 1, not 2"),
        ({"alpha": 0.5}, "alpha shapes the paper's falloff and has no effect with falloff='rig'"),
        ({"max_influences": 0}, "max_influences must be a whole number from 1 to 1,024, not 0"),
        ({"threshold": -1}, "threshold must be a number from 0 to 1, not -1"),
    ],
)
def test_options_are_checked_whichever_way_they_are_given(options, sentence):
    with pytest.raises(ParameterError, match=sentence):
        Method(**options)
    with pytest.raises(ParameterError, match=sentence):
        method_of("animation", **options)


def test_there_is_no_such_option_or_method():
    with pytest.raises(TypeError, match="no option 'treshold'; did you mean 'threshold'"):
        ANIMATION.with_options(treshold=0.1)
    with pytest.raises(TypeError, match="no option 'locked'; it has resolution, connectivity"):
        ANIMATION.with_options(locked=[])
    with pytest.raises(ParameterError, match="method must be one of 'animation', 'paper'"):
        method_of("papers")
    with pytest.raises(FrozenInstanceError):
        PAPER.alpha = 1


def test_the_types_of_options_name_all_there_are():
    named = {"resolution", *Options.__annotations__}
    assert named == {field.name for field in fields(Method)}


def test_how_many_joints_are_measured_follows_from_the_method():
    assert PAPER.joints_needed is None
    assert PAPER.with_options(max_influences=8).joints_needed == 8
    assert PAPER.with_options(max_influences=2).joints_needed == 8
    assert PAPER.with_options(max_influences=9).joints_needed == 9
    assert ANIMATION.joints_needed == 3
    assert ANIMATION.with_options(max_influences=None).joints_needed is None
    assert (PAPER.reach_needed, ANIMATION.reach_needed) == (np.inf, 6)


@pytest.mark.parametrize("bound", [0, 1, 0.0, 1.0, -0.1, float("nan")])
def test_the_bounds_of_the_winding_threshold_are_open(bound):
    """At 0 all of the cube would be inside, at 1 rounding alone would decide."""
    with pytest.raises(ParameterError, match="winding_threshold"):
        Method(winding_threshold=bound)
    with pytest.raises(ParameterError, match="winding_threshold"):
        build_graph(meshes.box(), 8, winding_threshold=bound)
    assert Method(winding_threshold=0.01).winding_threshold == 0.01
