"""The recipe is an honest peer: it builds the same graph and the same distances."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmarks import recipe
from cutcell import Rig, Skeleton, TriangleMesh, bind
from tests import meshes
from tests.paper import bone_distances, build_graph

# Turned, so that hardly any ray meets an edge, where float32 decides by itself.
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])


def torus():
    vertices, faces = meshes.torus()
    return TriangleMesh(vertices @ TURN.T, faces)


def casters():
    result = [recipe.hits_embree]
    try:
        import open3d  # noqa: F401
    except (ImportError, OSError):
        return result
    return [*result, recipe.hits_open3d]


def edges_by_place(nodes, edges, anchor):
    """Name nodes by where they are, by the nearest node of another graph."""
    distance, name = cKDTree(anchor).query(nodes)
    assert distance.max() < 2e-6
    return {tuple(sorted(edge)) for edge in name[edges].tolist()}


@pytest.mark.nightly
@pytest.mark.parametrize("cast", casters())
@pytest.mark.parametrize("resolution", [8, 24])
def test_the_same_graph(cast, resolution):
    mesh = torus()
    computed = build_graph(mesh, resolution, connectivity=6)
    reference = recipe.build_graph(mesh, resolution, cast)
    assert len(reference.nodes) == len(computed.nodes)
    assert len(reference.edges) == len(computed.edges)
    assert edges_by_place(reference.nodes, reference.edges, computed.nodes) == {
        tuple(sorted(edge)) for edge in computed.edges.tolist()
    }
    assert reference.lengths.sum() == pytest.approx(computed.lengths.sum(), rel=1e-5)


def test_the_same_distances_from_the_same_sources():
    mesh = torus()
    joints = np.array([[0.33, 0, 0], [0, 0.33, 0.02], [-0.33, 0, 0]])
    skeleton = Skeleton((joints + 0.5) @ TURN.T, [-1, 0, 1])
    graph = build_graph(mesh, 16, connectivity=6)
    computed = bone_distances(graph, skeleton)
    count = len(computed.bones.joint)
    augmented = recipe.with_bones(
        graph.csr(), computed.sources.bone, computed.sources.node, computed.sources.distance, count
    )
    reference = recipe.scipy_distances(augmented, count, graph.vertex_node)
    np.testing.assert_allclose(computed.joint, reference, rtol=1e-6, atol=1e-9)


@pytest.mark.nightly
def test_nearly_the_same_weights():
    mesh = torus()
    joints = np.array([[0.33, 0, 0], [0, 0.33, 0.02], [-0.33, 0, 0]])
    rig = Rig(mesh, Skeleton((joints + 0.5) @ TURN.T, [-1, 0, 1]))
    computed = bind(rig, 24, connectivity=6, falloff="paper").weights
    reference = recipe.bind(rig, 24)
    np.testing.assert_allclose(reference.sum(axis=1), 1)
    assert np.abs(computed - reference).mean() < 0.01


def test_far_parts_follow_their_nearest_bones():
    one, faces = meshes.ball(1)
    mesh = TriangleMesh(np.concatenate([one, one + 3]), np.concatenate([faces, faces + len(one)]))
    joints = [[0.4, 0.5, 0.5], [0.6, 0.5, 0.5], [0.5, 0.6, 0.5], [0.5, 0.5, 0.6], [0.5, 0.4, 0.5]]
    weights = recipe.bind(Rig(mesh, Skeleton(joints, [-1] * 5)), 16)
    assert np.isfinite(weights).all()
    np.testing.assert_array_equal((weights[len(one) :] > 0).sum(axis=1), 3)
