"""A solver prepares a graph once, and computes distances of many skeletons."""

import gc
import weakref

import numpy as np
import pytest

from cutcell import Skeleton, TriangleMesh, build_graph
from cutcell.geodesics import BoneDistanceSolver, bone_distances
from tests import meshes

CHAIN = [[0.5, 0.5, 0.15 * k] for k in range(1, 7)]


@pytest.mark.parametrize("connectivity", ["any", 6])
def test_distances_equal_those_of_a_fresh_graph(connectivity):
    graph = build_graph(TriangleMesh(*meshes.ball()), 12, connectivity=connectivity)
    solver = BoneDistanceSolver(graph)
    assert (solver.contraction is None) == (connectivity == 6)
    contraction, grid = solver.contraction, solver.grid
    for count in (2, 6):
        skeleton = Skeleton(CHAIN[:count], range(-1, count - 1))
        distances = bone_distances(solver, skeleton)
        np.testing.assert_array_equal(distances.joint, bone_distances(graph, skeleton).joint)
        assert distances.solver is solver
    assert solver.contraction is contraction
    assert solver.grid is grid


def test_nothing_keeps_a_graph_whose_distances_are_gone():
    graph = build_graph(TriangleMesh(*meshes.ball()), 8)
    distances = bone_distances(graph, Skeleton(CHAIN, range(-1, 5)))
    left = weakref.ref(graph)
    del graph, distances
    gc.collect()
    assert left() is None
