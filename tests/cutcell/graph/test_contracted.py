"""Fewer nodes, and the same ways."""

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

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
    beside, degree = graph.contracted.beside, np.diff(graph.contracted.adjacency[0])
    passed = beside >= 0
    assert not passed[: graph.first_crossing].any()
    assert (degree[passed] == 0).all()
    assert (degree[~passed] > 0).all()
    for node in range(graph.first_crossing, len(graph.nodes)):
        inside = graph.edges[(graph.edge_kind == 1) & (graph.edges == node).any(axis=1)]
        others = inside[inside != node]
        alone = len(others) == 1 and graph.first_point <= others[0] < graph.first_crossing
        assert beside[node] == (others[0] if alone else -1)


def test_where_the_body_is_thinner_than_a_cell_crossings_stay():
    vertices, faces = meshes.ALL["box"]()
    thin = TriangleMesh(vertices * [1, 1, 0.02], faces)
    graph = build_graph(thin, 16)
    assert graph.first_crossing < len(graph.nodes)
    along = graph.nodes[graph.first_crossing :, :2]
    across = np.isclose(along * 16 % 1, 0.5).all(axis=1)  # their rays run along z
    assert across.any()
    assert (graph.contracted.beside[graph.first_crossing :][across] == -1).all()
