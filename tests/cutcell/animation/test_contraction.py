"""Contracted graphs: fewer nodes, connected as before."""

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from cutcell import TriangleMesh
from cutcell.animation.any_angle.contraction import contract
from cutcell.graph import build_graph
from tests import meshes


def contracted_nodes(graph):
    """Tell which nodes are contracted, and the representative of each node."""
    nodes = np.arange(len(graph.nodes))
    representative = contract(graph).representative(nodes)
    return representative != nodes, representative


def contracted_edges(graph):
    """List both ends of each edge that is left, as nodes of the graph, in both directions."""
    left = contract(graph)
    begin = np.repeat(np.arange(len(left.node)), np.diff(left.indptr))
    return left.node[begin], left.node[left.indices]


@pytest.mark.parametrize("name", meshes.ALL)
def test_without_blocks_only_surface_nodes_are_merged(name):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 5)  # too coarse for a block
    _, representative = contracted_nodes(graph)
    # A contracted surface node merges with its lattice point; all other edges stay.
    expected = representative[graph.edges]
    expected = expected[expected[:, 0] != expected[:, 1]]
    expected = np.unique(np.concatenate([expected, expected[:, ::-1]]), axis=0)
    result = np.unique(np.stack(contracted_edges(graph), axis=1), axis=0)
    np.testing.assert_array_equal(result, expected)


@pytest.mark.parametrize("name", ["ball", "touching"])
def test_surface_nodes_of_a_single_segment_are_contracted(name):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 16)
    left, (contracted, representative) = contract(graph), contracted_nodes(graph)
    assert not contracted[: graph.first_point].any()
    np.testing.assert_array_equal(left.node, np.flatnonzero(~contracted))
    np.testing.assert_array_equal(left.places, graph.nodes[left.node])
    assert left.first_surface == (left.node < graph.first_surface).sum()
    assert (np.diff(left.indptr) > 0).all()
    for node in range(graph.first_surface, len(graph.nodes)):
        inside = graph.edges[(graph.edge_kind == 1) & (graph.edges == node).any(axis=1)]
        others = inside[inside != node]
        alone = len(others) == 1 and graph.first_point <= others[0] < graph.first_surface
        assert representative[node] == (others[0] if alone else node)


def test_surface_nodes_stay_where_the_body_is_thinner_than_a_cell():
    vertices, faces = meshes.ALL["box"]()
    thin = TriangleMesh(vertices * [1, 1, 0.02], faces)
    graph = build_graph(thin, 16)
    assert graph.first_surface < len(graph.nodes)
    along = graph.nodes[graph.first_surface :, :2]
    across = np.isclose(along * 16 % 1, 0.5).all(axis=1)  # their rays run along z
    assert across.any()
    assert not contracted_nodes(graph)[0][graph.first_surface :][across].any()


@pytest.mark.parametrize("resolution", [16, 17])
@pytest.mark.parametrize("name", meshes.ALL)
def test_components_are_those_of_the_graph(name, resolution):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), resolution, connectivity="any")
    left = contract(graph)
    count = len(left.node)
    less = csr_array((np.ones(len(left.indices)), left.indices, left.indptr), shape=(count, count))
    before = connected_components(graph.csr(), directed=False)[1]
    after = connected_components(less, directed=False)[1]
    # Contracted nodes are in the component of their representative.
    pairs = np.unique(np.stack([before, after[left.number]]), axis=1)
    assert len(np.unique(pairs[0])) == len(np.unique(pairs[1])) == pairs.shape[1]


def test_edges_between_blocks_are_straight_and_unique():
    graph = build_graph(TriangleMesh(*meshes.ALL["ball"]()), 32, connectivity="any")
    begin, end = contracted_edges(graph)
    assert len(np.unique(np.stack([begin, end]), axis=1).T) == len(begin)
    contracted, representative = contracted_nodes(graph)
    points = np.arange(graph.first_point, graph.first_surface)
    innermost = np.unique(representative[points[contracted[points]]])
    assert len(innermost) > 100
    both = np.isin(begin, innermost) & np.isin(end, innermost)
    assert both.sum() > len(innermost)
    cells = np.abs(graph.nodes[begin[both]] - graph.nodes[end[both]]) * 32
    assert ((cells > 1e-9).sum(axis=1) == 1).all()
    assert set(np.rint(cells.max(axis=1))) == {1, 2}
