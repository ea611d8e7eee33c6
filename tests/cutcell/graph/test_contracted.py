"""Fewer nodes, and ways as good."""

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from cutcell import TriangleMesh
from cutcell.graph import build_graph
from tests import meshes


def passed_over(graph):
    """Tell which nodes are passed over, and which node of the graph stands for each."""
    stands = graph.contracted.node[graph.contracted.number]
    return stands != np.arange(len(graph.nodes)), stands


def edges_left(graph):
    """List both ends of each edge that is left, as nodes of the graph, both ways round."""
    left = graph.contracted
    begin = np.repeat(np.arange(len(left.node)), np.diff(left.indptr))
    return left.node[begin], left.node[left.indices]


@pytest.mark.parametrize("name", meshes.ALL)
def test_where_blocks_are_none_ways_lead_round_what_is_passed_over(name):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 16)
    assert len(graph.steps) == 0
    _, stands = passed_over(graph)
    # A passed crossing merges with its lattice point; all other edges stay.
    expected = stands[graph.edges]
    expected = expected[expected[:, 0] != expected[:, 1]]
    expected = np.unique(np.concatenate([expected, expected[:, ::-1]]), axis=0)
    found = np.unique(np.stack(edges_left(graph), axis=1), axis=0)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("name", ["ball", "touching"])
def test_crossings_beside_one_lattice_point_are_passed_over(name):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 16)
    left, (passed, stands) = graph.contracted, passed_over(graph)
    assert not passed[: graph.first_crossing].any()
    np.testing.assert_array_equal(left.node, np.flatnonzero(~passed))
    np.testing.assert_array_equal(left.places, graph.nodes[left.node])
    assert left.first_crossing == graph.first_crossing
    assert (np.diff(left.indptr) > 0).all()
    for node in range(graph.first_crossing, len(graph.nodes)):
        inside = graph.edges[(graph.edge_kind == 1) & (graph.edges == node).any(axis=1)]
        others = inside[inside != node]
        alone = len(others) == 1 and graph.first_point <= others[0] < graph.first_crossing
        assert stands[node] == (others[0] if alone else node)


def test_where_the_body_is_thinner_than_a_cell_crossings_stay():
    vertices, faces = meshes.ALL["box"]()
    thin = TriangleMesh(vertices * [1, 1, 0.02], faces)
    graph = build_graph(thin, 16)
    assert graph.first_crossing < len(graph.nodes)
    along = graph.nodes[graph.first_crossing :, :2]
    across = np.isclose(along * 16 % 1, 0.5).all(axis=1)  # their rays run along z
    assert across.any()
    assert not passed_over(graph)[0][graph.first_crossing :][across].any()


@pytest.mark.parametrize("resolution", [16, 17])
@pytest.mark.parametrize("name", meshes.ALL)
def test_what_is_left_hangs_together_as_before(name, resolution):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), resolution, connectivity="any")
    left = graph.contracted
    count = len(left.node)
    less = csr_array((np.ones(len(left.indices)), left.indices, left.indptr), shape=(count, count))
    before = connected_components(graph.csr(), directed=False)[1]
    after = connected_components(less, directed=False)[1]
    # Also what is passed over hangs together with what stands for it.
    pairs = np.unique(np.stack([before, after[left.number]]), axis=1)
    assert len(np.unique(pairs[0])) == len(np.unique(pairs[1])) == pairs.shape[1]


def test_edges_between_blocks_are_straight_and_there_once():
    graph = build_graph(TriangleMesh(*meshes.ALL["ball"]()), 32, connectivity="any")
    begin, end = edges_left(graph)
    assert len(np.unique(np.stack([begin, end]), axis=1).T) == len(begin)
    passed, stands = passed_over(graph)
    points = np.arange(graph.first_point, graph.first_crossing)
    innermost = np.unique(stands[points[passed[points]]])
    assert len(innermost) > 100
    both = np.isin(begin, innermost) & np.isin(end, innermost)
    assert both.sum() > len(innermost)
    cells = np.abs(graph.nodes[begin[both]] - graph.nodes[end[both]]) * 32
    assert ((cells > 1e-9).sum(axis=1) == 1).all()
    assert set(np.rint(cells.max(axis=1))) == {1, 2}
