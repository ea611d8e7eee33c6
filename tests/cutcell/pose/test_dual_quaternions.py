"""Dual quaternion skinning, against its invariants and a loop over one vertex at a time."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from cutcell import dual_quaternion_skinning, linear_blend_skinning
from cutcell.errors import ParameterError
from cutcell.pose import axis_rotation
from cutcell.pose.dual_quaternions import HALF_TURN, rotation_quaternions
from cutcell_viewers.skin import MAX_INFLUENCES, Gap, Skin

SEEDS = st.integers(0, 2**32 - 1)


def rigid(rng, count, degrees=180):
    """Return random rigid motions (count, 4, 4)."""
    pose = np.tile(np.eye(4), (count, 1, 1))
    turns = Rotation.random(count, rng=rng).as_rotvec() * degrees / 180
    pose[:, :3, :3] = Rotation.from_rotvec(turns).as_matrix()
    pose[:, :3, 3] = rng.normal(size=(count, 3))
    return pose


def scaled(pose, scales):
    """Return a pose whose joints scale first, by numbers or by triples of them."""
    factors = np.broadcast_to(np.reshape(scales, (len(pose), -1)), (len(pose), 3))
    return pose @ np.array([np.diag([*one, 1.0]) for one in factors])


def shifted(pose, offset):
    """Return a pose in coordinates that are moved by an offset."""
    there, back = np.eye(4), np.eye(4)
    there[:3, 3], back[:3, 3] = offset, -offset
    return there @ pose @ back


def slowly(point, shares, pose):
    """Blend one vertex, term by term as in the paper; for rigid motions."""

    def times(p, q):
        x, y = p[:3], q[:3]
        return np.array([*(p[3] * y + q[3] * x + np.cross(x, y)), p[3] * q[3] - x @ y])

    if not shares.any():
        return point
    turns = Rotation.from_matrix(pose[:, :3, :3]).as_quat()
    real, dual = np.zeros(4), np.zeros(4)
    for share, turn, matrix in zip(shares, turns, pose, strict=True):
        sign = -1 if turn @ turns[np.argmax(shares)] < 0 else 1
        real += sign * share * turn
        dual += sign * share * times(np.array([*matrix[:3, 3], 0]), turn) / 2
    length = np.linalg.norm(real)
    real, dual = real / length, dual / length
    move = 2 * times(dual, real * [-1, -1, -1, 1])[:3]
    return Rotation.from_quat(real).apply(point) + move


@given(SEEDS)
def test_blending_one_vertex_at_a_time(seed):
    rng = np.random.default_rng(seed)
    points, pose = rng.normal(size=(20, 3)), rigid(rng, 5)
    quaternions = rotation_quaternions(pose)
    assume((np.abs(quaternions @ quaternions.T) > 2 * HALF_TURN).all())
    weights = rng.dirichlet(np.ones(5), size=20)
    weights[rng.random(20) < 0.2] = 0
    expected = [slowly(*pair, pose) for pair in zip(points, weights, strict=True)]
    assert_allclose(dual_quaternion_skinning(points, weights, pose), expected, atol=1e-9)
    skin = Skin.of_weights(weights)
    assert_allclose(skin.move(points, pose, "dual"), expected, atol=1e-5)


@given(SEEDS)
def test_a_single_joint_moves_its_vertices_by_its_matrix(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(20, 3))
    weights = np.eye(6)[rng.integers(0, 6, 20)]
    pose = np.tile(np.eye(4), (6, 1, 1))
    pose[:, :3] = rng.normal(size=(6, 3, 4))  # shears, and mirrors half of the time
    pose[0, :3, :3] = 0
    pose[1, 0, :3] = 0
    expected = linear_blend_skinning(points, weights, pose)
    assert_allclose(dual_quaternion_skinning(points, weights, pose), expected, atol=1e-12)


@given(SEEDS)
def test_joints_that_move_alike_move_as_one(seed):
    rng = np.random.default_rng(seed)
    points, weights = rng.normal(size=(20, 3)), rng.dirichlet(np.ones(4), size=20)
    pose = np.repeat(rigid(rng, 1), 4, axis=0)
    expected = linear_blend_skinning(points, weights, pose)
    assert_allclose(dual_quaternion_skinning(points, weights, pose), expected, atol=1e-12)


@given(SEEDS)
def test_joints_that_only_scale_and_shift_are_blended_linearly(seed):
    rng = np.random.default_rng(seed)
    points, weights = rng.normal(size=(20, 3)), rng.dirichlet(np.ones(4), size=20)
    pose = scaled(np.tile(np.eye(4), (4, 1, 1)), rng.uniform(0.3, 3, (4, 3)))
    pose[:, :3, 3] = rng.normal(size=(4, 3))
    expected = linear_blend_skinning(points, weights, pose)
    assert_allclose(dual_quaternion_skinning(points, weights, pose), expected, atol=1e-12)


@given(SEEDS)
def test_a_scale_that_joints_share_is_the_first_of_two_phases(seed):
    rng = np.random.default_rng(seed)
    points, weights = rng.normal(size=(20, 3)), rng.dirichlet(np.ones(4), size=20)
    pose, scale = rigid(rng, 4, degrees=80), rng.uniform(0.3, 3)
    expected = dual_quaternion_skinning(scale * points, weights, pose)
    result = dual_quaternion_skinning(points, weights, scaled(pose, [scale] * 4))
    assert_allclose(result, expected, atol=1e-9)


@given(SEEDS, st.booleans())
def test_the_result_is_the_same_from_any_origin(seed, has_scale):
    rng = np.random.default_rng(seed)
    points, weights = rng.normal(size=(20, 3)), rng.dirichlet(np.ones(4), size=20)
    pose, offset = rigid(rng, 4, degrees=80), rng.normal(size=3) * 10
    if has_scale:
        pose = scaled(pose, rng.uniform(0.3, 3, 4))
    still = dual_quaternion_skinning(points, weights, pose)
    moved = dual_quaternion_skinning(points + offset, weights, shifted(pose, offset))
    assert_allclose(moved, still + offset, atol=1e-9)


@pytest.mark.parametrize("degrees", [90, 179, 180])
def test_a_twisted_cylinder_keeps_its_radius_where_linear_blending_collapses(degrees):
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    ring = np.stack([np.cos(angles), np.sin(angles), np.full(16, 0.5)], axis=1)
    weights = np.full((16, 2), 0.5)
    pose = np.tile(np.eye(4), (2, 1, 1))
    pose[1, :3, :3] = axis_rotation("z", degrees)
    linear = np.linalg.norm(linear_blend_skinning(ring, weights, pose)[:, :2], axis=1)
    assert_allclose(linear, np.cos(np.radians(degrees / 2)), atol=1e-12)
    dual = dual_quaternion_skinning(ring, weights, pose)
    expected = ring @ axis_rotation("z", degrees / 2).T
    assert_allclose(dual, expected, atol=1e-12)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 2, 0.5)])
def test_rounding_does_not_choose_the_side_of_a_half_turn(axis):
    pose = np.tile(np.eye(4), (2, 1, 1))
    result = []
    for degrees in (180 - 1e-5, 180, 180 + 1e-5):
        pose[1, :3, :3] = axis_rotation(axis, degrees).astype(np.float32)
        result.append(dual_quaternion_skinning([[1.0, 2, 3]], [[0.6, 0.4]], pose))
    assert_allclose(np.ptp(result, axis=0), 0, atol=1e-5)


@given(SEEDS)
def test_quaternions_are_those_of_the_nearest_rotations(seed):
    rng = np.random.default_rng(seed)
    pose = rigid(rng, 8)
    quaternions = rotation_quaternions(scaled(pose, rng.uniform(0.1, 9, (8, 1))))
    assert_allclose(Rotation.from_quat(quaternions).as_matrix(), pose[:, :3, :3], atol=1e-9)
    assert (quaternions[:, 3] > -1e-4).all()
    mirrored = scaled(pose, [[-1.0, 1, 1]] * 8)
    assert_array_equal(rotation_quaternions(mirrored), np.tile([0.0, 0, 0, 1], (8, 1)))


@given(SEEDS)
def test_normals_turn_as_the_skin_does(seed):
    rng = np.random.default_rng(seed)
    skin = Skin.of_weights(rng.dirichlet(np.ones(4), size=20))
    points, normals, pose = rng.normal(size=(20, 3)), rng.normal(size=(20, 3)), rigid(rng, 4, 80)
    ends = [skin.move(points + end, pose, "dual") for end in (normals, 0 * normals)]
    along = (ends[0] - ends[1]) / np.linalg.norm(normals, axis=1, keepdims=True)
    assert_allclose(skin.turn(normals, pose, "dual"), along, atol=1e-6)


@given(SEEDS)
def test_the_gap_is_between_positions_of_the_same_blending(seed):
    rng = np.random.default_rng(seed)
    points, pose = rng.normal(size=(20, 3)), rigid(rng, MAX_INFLUENCES, 80)
    computed, reference = rng.dirichlet(np.ones(MAX_INFLUENCES), size=(2, 20))
    reference[3] = 0
    apart = dual_quaternion_skinning(points, computed, pose)
    apart -= dual_quaternion_skinning(points, reference, pose)
    result = Gap(points, computed, reference, 2.0, "dual").lengths(pose)
    assert_allclose(result, 2 * np.linalg.norm(apart, axis=1), atol=1e-4)


def test_vertices_without_weight_stand_still():
    assert_array_equal(dual_quaternion_skinning([[1.0, 2, 3]], [[0.0]], 7 * np.eye(4)[None]),
                       [[1, 2, 3]])  # fmt: skip
    assert_array_equal(dual_quaternion_skinning([[1.0, 2, 3]], np.empty((1, 0)),
                                                np.empty((0, 4, 4))), [[1, 2, 3]])  # fmt: skip


def test_shapes_that_do_not_fit_are_rejected():
    with pytest.raises(ParameterError, match="vertices have the shape"):
        dual_quaternion_skinning([[0, 0]], [[1]], np.eye(4)[None])
