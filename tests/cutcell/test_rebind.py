"""Binding again with other joints: the graph stays, and weights are those of a fresh binding."""

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


def test_a_graph_of_something_else_is_refused():
    graph = cutcell.build_graph(RIG.mesh, 16)
    with pytest.raises(ParameterError, match="built with resolution=16, the method has 24"):
        cutcell.bind(RIG, 24, graph=graph)
    with pytest.raises(ParameterError, match="built with connectivity='any'"):
        cutcell.bind(RIG, 16, method="paper", graph=graph)
    other = cutcell.TriangleMesh(np.array([0.3, 0, 0]) + RIG.mesh.vertices, RIG.mesh.faces)
    with pytest.raises(ParameterError, match="of another mesh"):
        cutcell.bind(replace(RIG, mesh=other), 16, graph=graph)
