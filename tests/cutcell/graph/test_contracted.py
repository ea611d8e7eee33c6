"""Fewer nodes, and ways as good."""

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from cutcell import TriangleMesh
from cutcell.graph import build_graph
from tests import meshes


@pytest.mark.parametrize("name", meshes.ALL)
def test_no_way_becomes_longer_or_shorter(name):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 16)
    indptr, indices, lengths = graph.contracted.adjacency
    less = csr_array((lengths, indices, indptr), shape=(len(graph.nodes),) * 2)
    begin = np.arange(min(graph.first_point, 12))
    found, expected = (
        dijkstra(matrix, indices=begin)[:, : graph.first_crossing] for matrix in (less, graph.csr())
    )
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("name", ["ball", "touching"])
def test_crossings_beside_one_lattice_point_are_passed_over(name):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 16)
    stand_in, degree = graph.contracted.stand_in, np.diff(graph.contracted.adjacency[0])
    passed = stand_in >= 0
    assert not passed[: graph.first_crossing].any()
    assert (degree[passed] == 0).all()
    assert (degree[~passed] > 0).all()
    for node in range(graph.first_crossing, len(graph.nodes)):
        inside = graph.edges[(graph.edge_kind == 1) & (graph.edges == node).any(axis=1)]
        others = inside[inside != node]
        alone = len(others) == 1 and graph.first_point <= others[0] < graph.first_crossing
        assert stand_in[node] == (others[0] if alone else -1)


def test_where_the_body_is_thinner_than_a_cell_crossings_stay():
    vertices, faces = meshes.ALL["box"]()
    thin = TriangleMesh(vertices * [1, 1, 0.02], faces)
    graph = build_graph(thin, 16)
    assert graph.first_crossing < len(graph.nodes)
    along = graph.nodes[graph.first_crossing :, :2]
    across = np.isclose(along * 16 % 1, 0.5).all(axis=1)  # their rays run along z
    assert across.any()
    assert (graph.contracted.stand_in[graph.first_crossing :][across] == -1).all()


@pytest.mark.parametrize("resolution", [16, 17])
@pytest.mark.parametrize("name", meshes.ALL)
def test_what_is_left_hangs_together_as_before(name, resolution):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), resolution, connectivity="any")
    indptr, indices, lengths = graph.contracted.adjacency
    less = csr_array((lengths, indices, indptr), shape=(len(graph.nodes),) * 2)
    stays = graph.contracted.stand_in < 0
    assert (np.diff(indptr)[~stays] == 0).all()
    before, after = (
        connected_components(matrix, directed=False)[1][stays] for matrix in (graph.csr(), less)
    )
    pairs = np.unique(np.stack([before, after]), axis=1)
    assert len(np.unique(pairs[0])) == len(np.unique(pairs[1])) == pairs.shape[1]


def test_edges_between_blocks_are_straight_and_there_once():
    graph = build_graph(TriangleMesh(*meshes.ALL["ball"]()), 32, connectivity="any")
    indptr, indices, lengths = graph.contracted.adjacency
    begin = np.repeat(np.arange(len(graph.nodes)), np.diff(indptr))
    assert len(np.unique(np.stack([begin, indices]), axis=1).T) == len(indices)
    stand_ins = np.unique(graph.contracted.stand_in[graph.first_point : graph.first_crossing])[1:]
    assert len(stand_ins) > 100
    both = np.isin(begin, stand_ins) & np.isin(indices, stand_ins)
    assert both.sum() > len(stand_ins)
    apart = graph.nodes[begin[both]] - graph.nodes[indices[both]]
    assert ((np.abs(apart) > 1e-9).sum(axis=1) == 1).all()
    np.testing.assert_allclose(np.abs(apart).sum(axis=1), lengths[both], rtol=1e-12)
    assert lengths[both].max() < 2.001 / 32
