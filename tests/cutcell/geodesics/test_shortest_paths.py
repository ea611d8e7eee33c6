"""Shortest paths equal slow Dijkstra's and SciPy's on graphs of every kind."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from cutcell import TriangleMesh
from cutcell.bones.bones import Sources
from cutcell.geodesics.shortest_paths import BONES_TOGETHER, shortest_paths
from tests import meshes, naive
from tests.paper import build_graph


def any_graph(nodes, edges, lengths):
    """Wrap nodes and edges as the graph of a mesh; shortest paths look at nothing else."""
    tiny = build_graph(TriangleMesh(*meshes.box()), 2)
    edges = np.asarray(edges, np.int32).reshape(-1, 2)
    return replace(tiny, nodes=np.asarray(nodes, float), edges=edges, lengths=np.asarray(lengths))


def some_sources(rng, count, bones, most=4):
    """Give each bone one source or more, some of them twice at different distances."""
    bone = np.sort(np.concatenate([np.arange(bones), rng.integers(0, bones, bones * (most - 1))]))
    node = rng.integers(0, count, len(bone))
    return Sources(node.astype(np.int32), bone.astype(np.int32), rng.random(len(bone)))


def slow(graph, sources, bones):
    """Run the oracle for each bone."""
    rows = []
    for bone in range(bones):
        starts = {}
        for k in np.flatnonzero(sources.bone == bone):
            node, distance = sources.node[k], sources.distance[k]
            starts[node] = min(starts.get(node, np.inf), distance)
        rows.append(naive.shortest_paths(len(graph.nodes), graph.edges, graph.lengths, starts))
    return np.array(rows)


@pytest.mark.parametrize("bones", [1, 2, BONES_TOGETHER, BONES_TOGETHER + 1, 20])
@pytest.mark.parametrize("degree", [0, 0.7, 3, 12])  # below 1, most parts are not reached
@pytest.mark.parametrize("seed", range(3))
def test_random_graphs(seed, degree, bones):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 80))
    edges = rng.integers(0, count, (int(degree * count), 2))  # loops and parallel edges, too
    lengths = np.where(rng.random(len(edges)) < 0.2, 0, rng.exponential(0.1, len(edges)))
    graph = any_graph(rng.random((count, 3)), edges, lengths)
    sources = some_sources(rng, count, bones)
    result = shortest_paths(graph, sources, bones, np.arange(count, dtype=np.int32))
    np.testing.assert_allclose(result, slow(graph, sources, bones), rtol=1e-12)


@pytest.mark.parametrize("connectivity", [6, 26])
def test_a_mesh_with_several_parts(connectivity):
    vertices, faces = meshes.ball(2)
    twice = TriangleMesh(
        np.concatenate([vertices, vertices + 1.5]), np.concatenate([faces, faces + len(vertices)])
    )
    graph = build_graph(twice, 24, connectivity=connectivity)
    count, bones = len(graph.nodes), 11
    sources = some_sources(np.random.default_rng(5), count, bones, most=1)
    targets = graph.vertex_node[::-3].astype(np.int32)
    result = shortest_paths(graph, sources, bones, targets)
    expected = dijkstra(graph.csr(), indices=sources.node) + sources.distance[:, None]
    np.testing.assert_allclose(result, expected[:, targets], rtol=1e-12)
    assert np.isinf(result).any(axis=1).all()  # the other ball
    assert np.isfinite(result).any(axis=1).all()


def test_a_vertex_of_no_face_may_lie_anywhere():
    vertices, faces = meshes.box()
    for far in (1e20, -1e20):
        mesh = TriangleMesh(np.vstack([vertices, [[far, far, far]]]), faces)
        graph = build_graph(mesh, 4)
        sources = Sources(graph.vertex_node[:1], np.array([0]), np.zeros(1))
        result = shortest_paths(graph, sources, 1, np.arange(len(graph.nodes), dtype=np.int32))
        np.testing.assert_allclose(result, slow(graph, sources, 1), rtol=1e-12)
        assert np.isfinite(result).sum() == len(graph.nodes) - 1


def test_a_path_that_turns_back_and_forth():
    # Up and down along the body, each way a little longer than the last.
    rng = np.random.default_rng(0)
    count = 400
    height = np.abs((np.arange(count) / 25) % 2 - 1)
    nodes = np.stack([rng.random(count) / 9, height, rng.random(count) / 9], axis=1)
    shuffled = rng.permutation(count)
    edges = np.stack([shuffled[:-1], shuffled[1:]], axis=1)
    lengths = rng.random(count - 1)
    graph = any_graph(nodes[np.argsort(shuffled)], edges, lengths)
    sources = Sources(shuffled[:1].astype(np.int32), np.zeros(1, np.int32), np.array([0.25]))
    result = shortest_paths(graph, sources, 1, shuffled.astype(np.int32))
    np.testing.assert_allclose(result[0], 0.25 + np.append(0, np.cumsum(lengths)), rtol=1e-12)


def test_a_long_way_round_beats_a_long_edge():
    graph = any_graph(np.eye(3), [[0, 1], [1, 2], [0, 2]], [0.1, 0.2, 0.4])
    matrix = csr_array(([0.1, 0.2, 0.4], ([0, 1, 0], [1, 2, 2])), shape=(3, 3))
    sources = Sources(np.zeros(1, np.int32), np.zeros(1, np.int32), np.zeros(1))
    result = shortest_paths(graph, sources, 1, np.arange(3, dtype=np.int32))
    np.testing.assert_allclose(result[0], dijkstra(matrix, directed=False, indices=0))


def test_no_bones_have_no_distances():
    graph = any_graph(np.eye(3), [[0, 1]], [1.0])
    nothing = Sources(np.empty(0, np.int32), np.empty(0, np.int32), np.empty(0))
    assert shortest_paths(graph, nothing, 0, np.arange(3, dtype=np.int32)).shape == (0, 3)
