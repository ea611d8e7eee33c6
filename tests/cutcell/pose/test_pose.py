"""Kinematics, blending and clips, against loops over one joint or vertex at a time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

import cutcell
from cutcell.pose import axis_rotation, pose_at, rotate_joint, swing


@st.composite
def skeletons(draw):
    """Draw a tree or several, in any order of joints, with random rotations."""
    count = draw(st.integers(1, 12))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    order = rng.permutation(count)
    parents = np.full(count, -1)
    for k in range(1, count):
        parents[order[k]] = draw(st.sampled_from([-1, *order[:k].tolist()]))
    skeleton = cutcell.Skeleton(rng.normal(size=(count, 3)), parents)
    return skeleton, Rotation.random(count, rng=rng).as_matrix(), rng


def about(point, rotation):
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = point - rotation @ point
    return matrix


@given(skeletons())
def test_kinematics_composes_parent_first(drawn):
    skeleton, rotations, _ = drawn

    def slowly(j):
        own = about(skeleton.joints[j], rotations[j])
        parent = skeleton.parents[j]
        return own if parent < 0 else slowly(parent) @ own

    transforms = cutcell.forward_kinematics(skeleton, rotations)
    expected = [slowly(j) for j in range(len(skeleton.joints))]
    assert_allclose(transforms, expected, atol=1e-11)


@given(skeletons())
def test_bones_keep_their_length(drawn):
    skeleton, rotations, _ = drawn
    transforms = cutcell.forward_kinematics(skeleton, rotations)
    at = np.einsum("jab,jb->ja", transforms, np.c_[skeleton.joints, np.ones(len(rotations))])
    held = np.flatnonzero(skeleton.parents >= 0)
    above = skeleton.parents[held]
    before = np.linalg.norm(skeleton.joints[held] - skeleton.joints[above], axis=1)
    after = np.linalg.norm(at[held] - at[above], axis=1)
    assert_allclose(after, before, atol=1e-10)


@given(skeletons())
def test_one_joint_moves_its_subtree_only(drawn):
    skeleton, _, rng = drawn
    joint = int(rng.integers(len(skeleton.joints)))
    transforms = rotate_joint(skeleton, joint, "y", 40)
    turn = about(skeleton.joints[joint], Rotation.from_euler("y", 40, degrees=True).as_matrix())
    for k in range(len(skeleton.joints)):
        expected = turn if skeleton.subtree[joint, k] else np.eye(4)
        assert_allclose(transforms[k], expected, atol=1e-12)


@given(st.lists(st.floats(-5, 5), min_size=3, max_size=3), st.floats(-720, 720))
def test_rotations_about_any_axis(axis, degrees):
    if np.linalg.norm(axis) < 1e-3:
        return
    unit = np.array(axis) / np.linalg.norm(axis)
    expected = Rotation.from_rotvec(unit * degrees, degrees=True).as_matrix()
    assert_allclose(axis_rotation(axis, degrees), expected, atol=1e-12)


@given(st.integers(0, 2**32 - 1))
def test_blending_one_vertex_at_a_time(seed):
    rng = np.random.default_rng(seed)
    n, j = rng.integers(1, 20), rng.integers(1, 6)
    vertices, weights = rng.normal(size=(n, 3)), rng.random((n, j))
    weights[rng.random(n) < 0.2] = 0
    transforms = rng.normal(size=(j, 4, 4))
    transforms[:, 3] = [0, 0, 0, 1]
    expected = vertices.copy()
    for i in range(n):
        if weights[i].any():
            expected[i] = sum(
                weights[i, k] * (transforms[k] @ [*vertices[i], 1])[:3] for k in range(j)
            )
    posed = cutcell.linear_blend_skinning(vertices, weights, transforms)
    assert_allclose(posed, expected, atol=1e-12)


def test_at_rest_nothing_moves():
    rng = np.random.default_rng(0)
    vertices, weights = rng.normal(size=(50, 3)), rng.dirichlet(np.ones(7), size=50)
    rest = np.tile(np.eye(4), (7, 1, 1))
    assert_allclose(cutcell.linear_blend_skinning(vertices, weights, rest), vertices, atol=1e-14)


def ramp():
    transforms = np.tile(np.eye(4), (3, 1, 1, 1))
    transforms[:, 0, 0, 3] = [0, 10, 40]
    return cutcell.Clip("ramp", np.array([0, 1.0, 2.0]), transforms)


@pytest.mark.parametrize(
    ("seconds", "x"),
    [(0, 0), (0.5, 5), (1, 10), (1.25, 17.5), (2, 40), (2.5, 5), (4.5, 5), (-1, 10), (-0.5, 25)],
)
def test_a_clip_is_mixed_between_frames_and_starts_again(seconds, x):
    assert pose_at(ramp(), seconds)[0, 0, 3] == pytest.approx(x)


def test_a_clip_of_one_frame_stands_still():
    still = cutcell.Clip("still", np.zeros(1), ramp().transforms[1:2])
    assert pose_at(still, 3.7)[0, 0, 3] == 10


def test_frames_at_the_same_time_are_a_jump():
    clip = cutcell.Clip("jump", np.array([0, 1.0, 1.0]), ramp().transforms)
    assert pose_at(clip, 0.999)[0, 0, 3] == pytest.approx(9.99)


def test_a_swing_goes_both_ways_and_loops():
    skeleton = cutcell.Skeleton([[0, 0, 0], [1, 0, 0]], [-1, 0], ("base", "arm"))
    clip = swing(skeleton, 1, "z", 30, seconds=2, fps=10)
    assert clip.name == "swing arm"
    assert clip.duration == 2
    assert len(clip.times) == 21
    assert_allclose(clip.transforms[0], clip.transforms[-1], atol=1e-12)
    assert_allclose(clip.transforms[5], rotate_joint(skeleton, 1, "z", 30), atol=1e-12)
    assert_allclose(clip.transforms[15], rotate_joint(skeleton, 1, "z", -30), atol=1e-12)
    assert_array_equal(clip.transforms[:, 0], np.tile(np.eye(4), (21, 1, 1)))


SKELETON = cutcell.Skeleton([[0, 0, 0], [1, 0, 0]], [-1, 0])
EYES = np.tile(np.eye(3), (2, 1, 1))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: cutcell.forward_kinematics(SKELETON, EYES[:1]), r"rotations has the shape"),
        (lambda: cutcell.forward_kinematics(SKELETON, EYES * np.nan), "rotations holds values"),
        (lambda: cutcell.forward_kinematics(SKELETON, "abc"), "rotations must be an array"),
        (lambda: rotate_joint(SKELETON, 2, "x", 5), "no joint 2: the skeleton's are 0 to 1"),
        (lambda: rotate_joint(SKELETON, -1, "x", 5), "no joint -1"),
        (lambda: rotate_joint(SKELETON, 0, "w", 5), 'axis "w" is none of x, y, z'),
        (lambda: rotate_joint(SKELETON, 0, [0, 0, 0], 5), "no direction"),
        (lambda: rotate_joint(SKELETON, 0, "x", np.inf), "degrees must be a finite number"),
        (lambda: cutcell.linear_blend_skinning([[0, 0]], [[1]], EYES), "vertices have the shape"),
        (lambda: cutcell.linear_blend_skinning([[0, 0, 0]], [[1]], EYES), "transforms have the"),
        (
            lambda: cutcell.linear_blend_skinning([[0, 0, 0]], [[1], [1]], [np.eye(4)]),
            "1 vertices but 2 rows of weights",
        ),
        (lambda: pose_at(ramp(), np.nan), "seconds must be finite numbers"),
        (
            lambda: pose_at(cutcell.Clip("none", np.zeros(0), np.zeros((0, 1, 4, 4))), 0),
            "a clip without frames cannot be played",
        ),
        (lambda: swing(SKELETON, 0, "x", 5, seconds=0), "seconds and fps must be positive"),
        (lambda: swing(SKELETON, 7, "x", 5), "no joint 7"),
    ],
)
def test_what_is_wrong_is_said(call, message):
    with pytest.raises(cutcell.ParameterError, match=message):
        call()
