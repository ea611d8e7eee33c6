"""The surface that stretches as joints turn: the fast measure against one that poses everything."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

import cutcell
from cutcell.binding.warnings import with_warnings
from cutcell.editing import Edits
from cutcell.graph import MESH, build_graph
from cutcell.pose import stretch as module
from cutcell.pose.stretch import MAX_SHARE, measure_stretch
from tests import naive
from tests.cutcell.diagnosis.worm import worm

WORM = worm()
GRAPH = build_graph(WORM.mesh, 8, connectivity="any")
CODE = "stretched-surface"


def edges_of(graph):
    vertex = np.unique(graph.vertex_node, return_index=True)[1]
    return vertex[graph.edges[graph.edge_kind == MESH]]


def spiked():
    """Weights of the worm of which the head follows the tail."""
    weights = WORM.weights.copy()
    head = WORM.mesh.vertices[:, 0] > 0.8
    weights[head] = 0
    weights[head, 1] = 1.0
    return weights


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.3, 1.0]))
def test_it_is_what_posing_the_whole_surface_gives(seed, evenness):
    random = np.random.default_rng(seed)
    weights = random.dirichlet(np.full(7, evenness), len(WORM.mesh.vertices))
    skeleton = replace(
        WORM.skeleton,
        joints=random.normal((0.5, 0, 0), 0.3, (7, 3)),
        parents=[-1, 0, 1, 1, 0, -1, 5],
    )
    measured = measure_stretch(GRAPH, skeleton, weights)
    share, by_joint = naive.stretch(WORM.mesh.vertices, edges_of(GRAPH), weights, skeleton)
    assert measured.share == pytest.approx(share, abs=1e-9)
    assert by_joint[measured.joint] == pytest.approx(by_joint.max())


def test_a_sample_of_the_edges_is_about_all_of_them(monkeypatch):
    weights = np.random.default_rng(3).dirichlet(np.full(7, 0.1), len(WORM.mesh.vertices))
    whole = measure_stretch(GRAPH, WORM.skeleton, weights).share
    monkeypatch.setattr(module, "MAX_EDGES", len(edges_of(GRAPH)) // 3)
    monkeypatch.setattr(module, "BLOCK_NUMBERS", 100)
    assert measure_stretch(GRAPH, WORM.skeleton, weights).share == pytest.approx(whole, abs=0.05)


def test_the_order_of_vertices_and_joints_and_the_scale_change_nothing(monkeypatch):
    monkeypatch.setattr(module, "MAX_EDGES", 100)
    random, weights = np.random.default_rng(4), spiked()
    measured = measure_stretch(GRAPH, WORM.skeleton, weights)
    vertices, joints = random.permutation(len(weights)), random.permutation(7)
    new_vertex, new_joint = np.argsort(vertices), np.argsort(joints)
    mesh = cutcell.TriangleMesh(WORM.mesh.vertices[vertices] * 100, new_vertex[WORM.mesh.faces])
    parents = WORM.skeleton.parents[joints]
    skeleton = cutcell.Skeleton(
        WORM.skeleton.joints[joints] * 100,
        np.where(parents >= 0, new_joint[parents], -1),
        [WORM.skeleton.names[j] for j in joints],
    )
    graph = build_graph(mesh, 8, connectivity="any")
    other = measure_stretch(graph, skeleton, weights[vertices][:, joints])
    assert other.share == measured.share
    assert joints[other.joint] == measured.joint
    assert vertices[other.vertex] == measured.vertex
    assert np.array_equal(np.sort(vertices[other.vertices]), measured.vertices)
    np.testing.assert_allclose(other.position, np.multiply(measured.position, 100), atol=1e-6)


def test_it_names_where_weights_are_bad():
    measured = measure_stretch(GRAPH, WORM.skeleton, spiked())
    assert measured.share > MAX_SHARE
    # All joints from the tail to the head tear the head's rim; the longest lever tears it most.
    assert 0.6 < measured.position[0] < 0.9
    assert np.isin(measured.vertex, measured.vertices)
    assert (WORM.mesh.vertices[measured.vertices, 0] > 0.6).all()


def test_what_moves_as_one_does_not_stretch():
    rigid = np.zeros_like(WORM.weights)
    rigid[:, 2] = 1.0
    for weights in (rigid, 0 * rigid):
        measured = measure_stretch(GRAPH, WORM.skeleton, weights)
        assert (measured.share, measured.joint, measured.vertex) == (0.0, None, None)
        assert len(measured.vertices) == 0


def test_bindings_and_checks_warn_of_it():
    binding = cutcell.bind(WORM, 16)
    assert binding.stretch.share < MAX_SHARE
    assert CODE not in {getattr(text, "code", "") for text in binding.warnings}
    worse = with_warnings(WORM, replace(binding, rows=csr_array(spiked())), Edits())
    assert worse.stretch.share > MAX_SHARE
    warning = next(text for text in worse.warnings if getattr(text, "code", "") == CODE)
    name = WORM.skeleton.names[worse.stretch.joint]
    assert f'"{name}"' in warning
    assert f"vertex {worse.stretch.vertex} " in warning
    finding = cutcell.diagnose(WORM.with_weights(spiked()), 16)[CODE]
    assert finding.joints.tolist() == [worse.stretch.joint]
    assert np.array_equal(finding.vertices, worse.stretch.vertices)
    assert finding.pose.degrees == 30


def test_a_binding_measures_it_once(monkeypatch):
    measured = []

    def measure(*inputs):
        measured.append(measure_stretch(*inputs))
        return measured[-1]

    monkeypatch.setattr("cutcell.binding.binding.measure_stretch", measure)
    binding = cutcell.bind(WORM, 16)
    assert [binding.stretch] == measured


def test_locked_weights_count_as_they_are_in_the_end():
    rig = WORM.with_weights(spiked())
    locked = cutcell.bind(rig, 16, locked=WORM.skeleton.names)
    assert locked.stretch.share > MAX_SHARE
    assert any(getattr(text, "code", "") == CODE for text in locked.warnings)


def test_vertices_without_weight_are_left_to_their_own_finding():
    weights = WORM.weights.copy()
    weights[WORM.mesh.vertices[:, 0] > 0.7] = 0
    assert measure_stretch(GRAPH, WORM.skeleton, weights).share < MAX_SHARE
