"""The error between two weightings, as it is coloured, listed and told."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutcell import linear_blend_skinning
from cutcell.pose import rotate_joint
from cutcell_viewers.character import pose_in_scene, to_scene
from cutcell_viewers.error_scene import (
    FLOOR,
    error_limits,
    gap_between,
    millimetres,
)
from cutcell_viewers.pose_scene import pose_scene


@pytest.fixture(scope="module")
def other(rig):
    weights = np.random.default_rng(3).random(rig.weights.shape)
    weights /= weights.sum(axis=1, keepdims=True)
    weights[:5] = 0  # these stand still
    return weights


def test_it_is_the_distance_in_millimetres_on_a_character_of_a_metre(rig, other):
    pose = pose_in_scene(rig, rotate_joint(rig.skeleton, 1, "y", 70))
    points = to_scene(rig, rig.mesh.vertices)
    computed = linear_blend_skinning(points, rig.weights, pose)
    reference = linear_blend_skinning(points, other, pose)
    metre = np.ptp(points, axis=0).max()
    expected = np.linalg.norm(1000 * (computed - reference) / metre, axis=1)
    np.testing.assert_allclose(
        gap_between(rig, rig.weights, other).lengths(pose), expected, rtol=2e-4, atol=1e-3
    )
    assert expected.max() > 30


def test_the_scene_shows_the_same_numbers(rig, other):
    transforms = rotate_joint(rig.skeleton, 1, "y", 70)
    scene = pose_scene(rig, rig.weights, transforms, reference=other)
    shown = scene.actors["body"]
    pose = pose_in_scene(rig, transforms)
    between = shown.skin.move(shown.points, pose) - shown.apart.skin.move(shown.points, pose)
    seen = shown.apart.unit * np.linalg.norm(between, axis=1)
    np.testing.assert_allclose(
        seen, gap_between(rig, rig.weights, other).lengths(pose), rtol=2e-3, atol=1e-2
    )
    assert scene.legend.high == f"{shown.limits[1]:g} mm"
    assert shown.limits[1] >= np.quantile(seen, 0.99)


@given(st.floats(1e-3, 1e6))
def test_the_scale_ends_at_a_round_number_that_holds_nearly_all(top):
    low, high = error_limits(np.linspace(0, top, 1000))
    assert low == 0
    assert high >= min(0.99 * top, high)
    assert high >= 0.98 * top
    assert high <= 2.01 * max(top, FLOOR)
    assert float(f"{high:.1e}") == pytest.approx(high)


def test_the_longest_side_counts_as_a_metre(rig):
    points = to_scene(rig, rig.mesh.vertices)
    assert millimetres(rig) * np.ptp(points, axis=0).max() == pytest.approx(1000)
