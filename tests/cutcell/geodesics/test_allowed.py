"""Distances of vertices that may follow different joints."""

import numpy as np
import pytest

import cutcell
from cutcell.geodesics import bone_distances
from cutcell.geodesics.fallback import NOT_ALLOWED
from tests.bars import bar

RIG = bar(48, joints=33)
GRAPH = cutcell.build_graph(RIG.mesh, 32)


def halves():
    """Let each half of a bar follow the joints of its half, and one vertex one joint."""
    joint, vertex = RIG.skeleton.joints[:, 0], RIG.mesh.vertices[:, 0]
    middle = joint.mean()
    allowed = (joint >= middle - 1e-9)[None] == (vertex >= middle - 1e-9)[:, None]
    return allowed


@pytest.mark.parametrize("make", [halves, lambda: np.ones_like(halves())])
def test_the_limit_to_nearest_joints_holds_among_allowed_ones(make):
    allowed = make()
    every = bone_distances(GRAPH, RIG.skeleton, allowed=allowed, nearest_joints=1000).joint
    result = bone_distances(GRAPH, RIG.skeleton, allowed=allowed)
    assert result.nearest_joints == 3
    measured = np.isfinite(result.joint)
    assert not measured[~allowed.T].any()
    assert measured.sum(axis=0).max() < 10 < np.isfinite(every).sum(axis=0).max()
    nearest = np.argsort(every, axis=0, kind="stable")[:1]
    assert np.take_along_axis(measured, nearest, axis=0).all()
    np.testing.assert_allclose(result.joint[measured], every[measured], atol=1e-9)
    assert not np.isfinite(result.of_all_joints().joint[~allowed.T]).any()
    np.testing.assert_array_equal(result.fallback, 0)


def test_where_all_are_allowed_weights_are_those_without_a_choice():
    every = np.ones_like(halves())
    chosen = bone_distances(GRAPH, RIG.skeleton, allowed=every)
    plain = bone_distances(GRAPH, RIG.skeleton)
    assert chosen.of_vertices is None
    assert chosen.fingerprint == plain.fingerprint
    np.testing.assert_allclose(
        cutcell.skinning_weights(chosen, allowed=every),
        cutcell.skinning_weights(plain),
        atol=1e-9,
    )


def test_weights_are_nearly_those_of_all_joints():
    allowed = halves()
    weights = [
        cutcell.skinning_weights(
            bone_distances(GRAPH, RIG.skeleton, allowed=allowed, nearest_joints=nearest),
            allowed=allowed,
        )
        for nearest in (None, 1000)
    ]
    # Joints as dense as these have more weight beyond the nearest ones than those of characters.
    np.testing.assert_allclose(*weights, atol=1e-3)


@pytest.mark.parametrize("method", ["animation", "paper"])
def test_weights_follow_a_mask_that_their_distances_did_not_know(method):
    rig = bar(24, joints=9)
    graph = cutcell.build_graph(rig.mesh, 24, method=method)
    distances = bone_distances(graph, rig.skeleton, method=method, nearest_joints=9, within=1e9)
    allowed = np.zeros((len(rig.mesh.vertices), 9), bool)
    allowed[:, 0] = allowed[::2, 7] = True
    weights = cutcell.skinning_weights(distances, method=method, allowed=allowed)
    np.testing.assert_array_equal(weights[~allowed], 0)
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    last = np.argmax(rig.mesh.vertices[::2, 0]) * 2
    assert weights[last, 7] > 0.5
    for wrong in (allowed[0], allowed[:, :3], np.zeros_like(allowed)):
        with pytest.raises(
            cutcell.WeightsError, match=r"allowed has the shape|may follow no joint"
        ):
            cutcell.skinning_weights(distances, method=method, allowed=wrong)


def test_a_mask_that_permits_only_what_was_not_measured_is_refused():
    """Nothing stands in for a distance; those by the same mask have it."""
    allowed = np.zeros((len(RIG.mesh.vertices), 33), bool)
    allowed[:, 0] = True
    with pytest.raises(cutcell.WeightsError, match="measure by `allowed`"):
        cutcell.skinning_weights(bone_distances(GRAPH, RIG.skeleton), allowed=allowed)
    distances = bone_distances(GRAPH, RIG.skeleton, allowed=allowed)
    assert (cutcell.skinning_weights(distances, allowed=allowed) == allowed).all()


def test_vertices_that_only_other_joints_reach_have_a_reason():
    rig, allowed, beside = RIG, halves(), np.array([0, 3, 0])
    vertices = np.concatenate([rig.mesh.vertices, rig.mesh.vertices + beside])
    faces = np.concatenate([rig.mesh.faces, rig.mesh.faces + len(rig.mesh.vertices)])
    joints = np.concatenate([rig.skeleton.joints, rig.skeleton.joints + beside])
    below = rig.skeleton.parents
    parents = np.concatenate([below, np.where(below >= 0, below + len(below), -1)])
    graph = cutcell.build_graph((vertices, faces), 64)
    skeleton = cutcell.Skeleton(joints, parents)
    crossed = np.kron([[0, 1], [1, 0]], np.ones_like(allowed)).astype(bool)
    result = bone_distances(graph, skeleton, allowed=crossed)
    np.testing.assert_array_equal(result.fallback, NOT_ALLOWED)


@pytest.mark.parametrize("has_skins", [False, True])
def test_distances_are_looked_up_as_in_a_matrix(has_skins):
    joints, vertices = len(RIG.skeleton.joints), len(RIG.mesh.vertices)
    allowed = np.ones((vertices, joints), bool)
    allowed[::2, 1] = not has_skins
    distances = bone_distances(GRAPH, RIG.skeleton, allowed=allowed, nearest_joints=2)
    expected = distances.joint
    assert expected.shape == (joints, vertices)
    some, few = np.array([4, 0, 7]), np.array([1, 0, 2])
    for joint, vertex in (
        (2, 5), (slice(None), 5), (slice(None), some), (2, slice(None)), (2, some),
        (few, some), (few, slice(None)), (slice(1, 3), slice(3, 9)), (few, 5),
    ):  # fmt: skip
        np.testing.assert_array_equal(distances.at(joint, vertex), expected[joint, vertex])
    np.testing.assert_array_equal(distances.nearest_joint, expected.argmin(axis=0))
    np.testing.assert_array_equal(distances.least, expected.min(axis=0))
