"""Conditions on vertices, against numpy."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell.errors import ParameterError, SkeletonError, WeightsError
from cutcell_app.editing.compute.condition import vertices_where
from tests.app.small import small_rig
from tests.bars import bar

NAMES = ("hand.L", "hand", "Left Arm and more", 'the "big" toe', "hand.L.001")


@pytest.fixture(scope="module")
def named():
    """Return a bound bar whose joints have names that are hard to read."""
    rig = bar(20, 5)
    skeleton = replace(rig.skeleton, names=NAMES)
    rig = replace(rig, skeleton=skeleton)
    binding = cutcell.bind(rig, 16)
    file_weights = np.roll(binding.weights, 1, axis=1)
    return replace(rig, weights=file_weights), binding


def test_conditions_are_what_numpy_says(named):
    rig, binding = named
    weights, file_weights = binding.weights, rig.weights
    size = binding.graph.lattice.size
    far = binding.distances.on_mesh(0) * size
    count = (weights > 0).sum(axis=1)
    cases = {
        "weight of hand.L > 0.1": weights[:, 0] > 0.1,
        "WEIGHT OF hand.l > 10%": weights[:, 0] > 0.1,
        "weight of hand>0.1": weights[:, 1] > 0.1,
        "weight of hand.L.001 >= 0": weights[:, 4] >= 0,
        "weight of Left Arm and more <= .5 and influences=2": (weights[:, 2] <= 0.5) & (count == 2),
        'weight of "Left Arm and more" <= 5e-1': weights[:, 2] <= 0.5,
        "weight of 'the \"big\" toe' != 0": weights[:, 3] > 1e-6,
        'weight of the "big" toe < 1': weights[:, 3] < 1,
        "file weight of hand ≥ 0.5": file_weights[:, 1] >= 0.5,
        "weight of hand.L > 0.1 and distance > 0.3": (weights[:, 0] > 0.1) & (far > 0.3),
        "distance to hand.L < 0.2": far < 0.2,
        "distance ≤ 0.1": binding.distances.least * size <= 0.1,
        "0.1 < weight of hand <= 0.9": (weights[:, 1] > 0.1) & (weights[:, 1] <= 0.9),
        "part = 1": np.ones(len(weights), bool),
        "x < 0 and Z >= .1": (rig.mesh.vertices[:, 0] < 0) & (rig.mesh.vertices[:, 2] >= 0.1),
        "weight of hand* > 0.5": weights[:, [0, 1, 4]].sum(axis=1) > 0.5,
        "weight of '*.L' > 0.1 and distance < 0.2": (weights[:, 0] > 0.1) & (far < 0.2),
        "part ≠ 1 or 2 > 1": np.ones(len(weights), bool),
        "weight of hand > weight of hand.L": weights[:, 1] > weights[:, 0],
        "not weight of hand > .5 and not (influences > 1 or part = 2)":
            (weights[:, 1] <= 0.5) & (count <= 1),
        "influences = 1 or influences = 2 and weight of hand > 0.5":
            (count == 1) | ((count == 2) & (weights[:, 1] > 0.5)),
    }  # fmt: skip
    for condition, expected in cases.items():
        result = vertices_where(condition, rig, weights, distances=binding.distances)
        assert result.dtype == bool
        assert np.array_equal(result, expected), condition


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        ("", "needs a number, weight, .* at its end"),
        ("weight", "needs `of` and a joint at its end"),
        ("weight of", "needs a joint at its end"),
        ("weight of > 1", "needs a joint at character 11"),
        ("file distance > 1", "needs `weight of` and a joint at character 6"),
        ("weight of hand.R > 1 and part = 1", 'there is no joint "hand.R" .* "hand'),
        ("weight of 'hand.L.001", "no joint"),
        ("weight of hand.L", "needs <, <=, .* at its end"),
        ("weight of hand.L 0.1", "needs <.* at character 18"),
        ("weight of *.R > 0", 'no joint "\\*.R"'),
        ("part = 1)", "needs `and`, `or` or the end at character 9, '\\)'"),
        ("(part = 1", "needs a closing parenthesis at its end"),
        ("part = 1 1", "at character 10, '1'"),
        ("part = __import__('os')", "at character 8"),
        ("not " * 99 + "part = 1", "nested 40 times"),
        ("(" * 99, "nested 40 times"),
        ("1" * 2000, "1,000 characters"),
        ("distance > 1", "once the character is bound"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_an_error_that_says_where(named, condition, message):
    rig, binding = named
    with pytest.raises(ParameterError, match=message):
        vertices_where(condition, rig, binding.weights)


def test_distances_to_joints_without_weight_and_weights_of_no_file_are_errors(named):
    rig, binding = named
    with pytest.raises(ParameterError, match="carries no weight, so there is no distance"):
        vertices_where("distance to hand.L.001 > 1", rig, binding.weights,
                       distances=binding.distances)  # fmt: skip
    bare = replace(rig, weights=None)
    with pytest.raises(WeightsError, match="no weights of its own"):
        vertices_where("file weight of hand > 1", bare, binding.weights)


def test_no_text_does_more_than_raise_an_error(named):
    rig, binding = named
    random = np.random.default_rng(2)
    words = ["weight", "of", "hand.L", "distance", "to", "and", "or", "not", "(", ")", "<", ">=",
             "0.1", "5%", "'", '"', "part", "influences", "file", "x y", "e", "-"]  # fmt: skip
    for _ in range(2000):
        text = " ".join(random.choice(words, random.integers(1, 9)))
        try:
            result = vertices_where(text, rig, binding.weights, distances=binding.distances)
        except (ParameterError, WeightsError):
            continue
        assert result.shape == (len(binding.weights),)


def test_a_side_is_that_of_names_and_needs_a_mirrored_skeleton(named):
    rig = small_rig()
    x = rig.mesh.vertices[:, 0]
    for side, expected in (("left", x > 1e-2), ("right", x < -1e-2), ("middle", abs(x) < 1e-2)):
        result = vertices_where(f"side = {side}", rig, rig.weights)
        np.testing.assert_array_equal(result, expected, side)
    with pytest.raises(SkeletonError, match="not mirrored"):
        vertices_where("side = left", named[0], named[1].weights)
