"""The falloff is the paper's formula, and pruning keeps the largest."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from cutcell import ParameterError, Skeleton, TriangleMesh
from cutcell.weights.paper_kernel import paper_kernel
from cutcell.weights.prune import prune
from tests import meshes, naive
from tests.paper import bone_distances, build_graph, skinning_weights

CHAIN = Skeleton([[0.5, 0.5, 0.15 * k] for k in range(1, 7)], range(-1, 5))


@pytest.fixture(scope="module")
def distances():
    return bone_distances(build_graph(TriangleMesh(*meshes.ball()), 12), CHAIN)


@pytest.mark.parametrize("alpha", [0, 0.3, 0.5, 1])
def test_paper_falloff_is_equation_1(distances, alpha):
    result = skinning_weights(distances, alpha=alpha, max_influences=None)
    expected = naive.paper_weights(distances.joint, distances.graph.lattice.diagonal, alpha)
    np.testing.assert_allclose(result, expected, atol=1e-12)


@pytest.mark.parametrize("alpha", [0, 0.5, 1])
def test_bones_that_touch_a_vertex_share_it(alpha):
    distance = np.array([[0.0, 1e-200, 0.2], [0.0, 1.0, np.inf], [0.5, 1.0, 0.2]])
    weights = paper_kernel(distance, 1.0, alpha)
    np.testing.assert_allclose(weights, [[0.5, 0.5, 0], [1, 0, 0], [0.5, 0, 0.5]], atol=1e-12)


@pytest.mark.parametrize("influences", [1, 2, 4, 6, None])
def test_rows_sum_to_one(distances, influences):
    weights = skinning_weights(distances, max_influences=influences)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    assert (weights >= 0).all()
    assert (weights > 0).sum(axis=1).max() == (influences or 6)


def test_vertices_at_one_place_may_follow_different_joints():
    vertices, faces = meshes.ball()
    corners = vertices[faces.ravel()]  # each triangle has corners of its own
    mesh = TriangleMesh(corners, np.arange(len(corners)).reshape(-1, 3))
    graph = build_graph(mesh, 12)
    allowed = np.random.default_rng(0).random((len(corners), 6)) < 0.6
    allowed[:, 0] = True
    distances = bone_distances(graph, CHAIN, allowed=allowed)
    result = skinning_weights(distances, max_influences=None, allowed=allowed)
    free = skinning_weights(bone_distances(graph, CHAIN), max_influences=None)
    expected = np.where(allowed, free, 0)
    np.testing.assert_allclose(result, expected / expected.sum(axis=1, keepdims=True), atol=1e-12)


def test_pruning_keeps_the_largest():
    weights = csr_array([[0.1, 0.4, 0.2, 0.3], [0.25, 0.25, 0.25, 0.25]])
    order = np.array([3, 2, 1, 0])
    result = prune(weights, 2, 0.0, order).toarray()
    np.testing.assert_allclose(result, [[0, 4 / 7, 0, 3 / 7], [0, 0, 0.5, 0.5]])
    result = prune(weights, None, 0.22, order).toarray()
    np.testing.assert_allclose(result[0], [0, 4 / 7, 0, 3 / 7])
    result = prune(weights, None, 0.9, order).toarray()
    np.testing.assert_allclose(result[0], [0, 1, 0, 0])


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("alpha", 1.5, "alpha must be a number from 0 to 1, not 1.5"),
        ("alpha", float("nan"), "alpha must be a number from 0 to 1, not nan"),
        ("alpha", "soft", "alpha must be a number from 0 to 1, not 'soft'"),
        ("threshold", -1, "threshold must be a number from 0 to 1, not -1"),
        ("max_influences", 0, "max_influences must be a whole number from 1"),
        ("falloff", "linear", "falloff must be one of 'rig', 'paper', not 'linear'"),
    ],
)
def test_parameters_are_checked(distances, name, value, sentence):
    with pytest.raises(ParameterError, match=sentence):
        skinning_weights(distances, **{name: value})


def test_alpha_is_refused_where_it_has_no_effect(distances):
    with pytest.raises(ParameterError, match="alpha shapes the paper's falloff and has no effect"):
        skinning_weights(distances, falloff="rig", alpha=0.5)


@pytest.mark.parametrize("influences", [4, None])
def test_more_influences_than_joints_were_measured(influences):
    graph = build_graph(TriangleMesh(*meshes.ball()), 8, connectivity="any")
    few = bone_distances(graph, CHAIN, nearest_joints=3)
    with pytest.raises(ParameterError, match="measured from the 3 nearest joints"):
        skinning_weights(few, max_influences=influences)
    # The nearest joints weigh most: the others would have been pruned.
    every = skinning_weights(bone_distances(graph, CHAIN), max_influences=3)
    np.testing.assert_allclose(skinning_weights(few, max_influences=3), every, atol=1e-9)
