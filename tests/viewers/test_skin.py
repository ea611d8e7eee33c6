"""Skinning by few influences equals linear blend skinning."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from cutcell import forward_kinematics, linear_blend_skinning
from cutcell_viewers.skin import MAX_INFLUENCES, Skin
from tests.viewers.arm import arm_rig


@given(st.integers(0, 2**32 - 1), st.integers(1, MAX_INFLUENCES))
def test_moving_is_linear_blend_skinning(seed, influences):
    random = np.random.default_rng(seed)
    weights = random.random((20, 12))
    weights[np.argsort(np.argsort(-weights, axis=1), axis=1) >= influences] = 0
    weights /= weights.sum(axis=1, keepdims=True)
    points = random.normal(size=(20, 3))
    pose = np.tile(np.eye(4), (12, 1, 1))
    pose[:, :3] = random.normal(size=(12, 3, 4))
    expected = linear_blend_skinning(points, weights, pose)
    np.testing.assert_allclose(Skin.of_weights(weights).move(points, pose), expected, atol=1e-5)


def test_the_largest_influences_are_kept_and_sum_to_one():
    skin = Skin.of_weights(np.random.default_rng(1).random((30, 40)))
    assert skin.joints.shape == (30, MAX_INFLUENCES)
    np.testing.assert_allclose(skin.weights.sum(axis=1), 1, atol=1e-6)


def test_points_without_weight_stand_still():
    points = np.array([[1.0, 2, 3], [4, 5, 6]])
    skin = Skin.of_weights([[0.0, 0], [0, 1]])
    pose = np.tile(np.eye(4), (2, 1, 1))
    pose[:, :3, 3] = 7
    np.testing.assert_allclose(skin.move(points, pose), [[1, 2, 3], [11, 12, 13]])


def test_what_hangs_on_a_joint_moves_with_it():
    rig = arm_rig()
    pose = forward_kinematics(rig.skeleton, np.tile(np.eye(3), (3, 1, 1)))
    pose[:, :3, 3] += [1.0, 2, 3]
    result = Skin.rigid([2]).move([[0.0, 0, 0]], pose)
    np.testing.assert_allclose(result, [[1, 2, 3]])


def test_normals_turn_and_stay_unit_vectors():
    quarter = np.eye(4)
    quarter[:2, :2] = [[0, -1], [1, 0]]
    quarter[:3, 3] = 5
    result = Skin.rigid([0]).turn([[1.0, 0, 0]], quarter[None])
    np.testing.assert_allclose(result, [[0, 1, 0]], atol=1e-12)
