"""Binding again with other joints: the graph stays, and weights are those of a fresh binding."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import ParameterError
from cutcell_assets import demo_path

RIG = cutcell.load(demo_path("robot"))


def moved(seed):
    rng = np.random.default_rng(seed)
    joints = RIG.skeleton.joints.copy()
    joints[rng.integers(len(joints))] += 0.02 * np.ptp(RIG.mesh.bounds) * rng.standard_normal(3)
    return replace(RIG, skeleton=replace(RIG.skeleton, joints=joints))


@pytest.mark.parametrize("method", ["animation", "paper"])
def test_weights_equal_those_of_a_fresh_binding(method):
    graph = cutcell.bind(RIG, 24, method=method).graph
    for seed in range(3):
        rig = moved(seed)
        again = cutcell.bind(rig, 24, method=method, graph=graph)
        assert again.graph is graph
        fresh = cutcell.bind(rig, 24, method=method)
        np.testing.assert_allclose(again.weights, fresh.weights, rtol=0, atol=1e-9)
    one_less = replace(RIG.skeleton, deform=np.arange(len(RIG.skeleton.joints)) > 0)
    rig = replace(RIG, skeleton=one_less)
    again = cutcell.bind(rig, 24, method=method, graph=graph).weights
    np.testing.assert_allclose(again, cutcell.bind(rig, 24, method=method).weights, atol=1e-9)


@pytest.mark.parametrize(
    "other",
    [
        {"resolution": 16},
        {"connectivity": 6},
        {"winding_threshold": 0.4},
        {"orient": False},
        {"method": "paper"},
    ],
)
def test_a_graph_by_another_method_is_refused(other):
    graph = cutcell.build_graph(RIG.mesh, **{"resolution": 24, **other})
    name = "connectivity" if "method" in other else next(iter(other))
    with pytest.raises(ParameterError, match=name):
        cutcell.bind(RIG, 24, graph=graph)
    fresh = cutcell.build_graph(cutcell.load(demo_path("robot")).mesh, 24)
    assert cutcell.bind(RIG, 24, graph=pickle.loads(pickle.dumps(fresh))).graph.is_closed


@pytest.mark.parametrize("change", ["moved", "half", "flipped", "reversed"])
def test_a_graph_of_another_mesh_is_refused(change):
    vertices, faces = RIG.mesh.vertices, RIG.mesh.faces
    other = {
        "moved": (vertices + np.array([0.3, 0, 0]), faces),
        "half": (vertices, faces[::2]),
        "flipped": (vertices, np.concatenate([faces[:1, ::-1], faces[1:]])),
        "reversed": (vertices, faces[::-1]),
    }[change]
    graph = cutcell.build_graph(RIG.mesh, 16)
    mesh = cutcell.TriangleMesh(*other)
    with pytest.raises(ParameterError, match="vertices" if change == "moved" else "faces"):
        cutcell.bind(replace(RIG, mesh=mesh), 16, graph=graph)
    with pytest.raises(ParameterError):
        cutcell.fit_skeleton(mesh, "biped", graph=graph)
    with pytest.raises(ParameterError):
        cutcell.bind(RIG, 16, graph=replace(graph, edges=graph.edges[::2]))


def test_distances_of_something_else_are_refused():
    binding = cutcell.bind(RIG, 16)
    assert cutcell.explain(RIG, 0, 16, distances=binding.distances).joints
    assert cutcell.diagnose(RIG, 16, distances=binding.distances, only_weights=True) is not None
    for rig in (
        moved(0),
        replace(
            RIG, skeleton=replace(RIG.skeleton, deform=np.arange(len(RIG.skeleton.joints)) > 0)
        ),
        replace(RIG, mesh=cutcell.TriangleMesh(RIG.mesh.vertices, RIG.mesh.faces[::2])),
    ):
        with pytest.raises(ParameterError):
            cutcell.explain(rig, 0, 16, distances=binding.distances)
        with pytest.raises(ParameterError):
            cutcell.diagnose(rig, 16, distances=binding.distances)
    for options in ({"samples": 7}, {"leaf": "point"}, {"connectivity": 6}, {"resolution": 24}):
        with pytest.raises(ParameterError, match=next(iter(options))):
            cutcell.explain(RIG, 0, distances=binding.distances, **{"resolution": 16, **options})
