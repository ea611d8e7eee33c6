"""What is computed can be copied, pickled, and handed to other processes."""

import multiprocessing
import pickle
from copy import deepcopy

import numpy as np
import pytest

import cutcell
from tests.bars import bar

RIG = bar()


def bind(rig):
    return cutcell.bind(rig, 16)


@pytest.fixture(scope="module", params=["fresh", "used"])
def binding(request):
    binding = bind(RIG)
    if request.param == "used":  # with all that is computed on demand
        _ = binding.stretch, binding.distances.joint, binding.distances.inside
        _ = binding.graph.adjacency, binding.graph.connected
        cutcell.geodesics.trace_path(binding.distances, 0, 0)
    return binding


@pytest.mark.parametrize("copy", [deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_computes_the_same(binding, copy):
    again = copy(binding)
    np.testing.assert_array_equal(again.weights, binding.weights)
    assert again.graph is again.distances.graph
    np.testing.assert_array_equal(again.distances.field(1), binding.distances.field(1))
    skinned = cutcell.skinning_weights(copy(binding.distances))
    np.testing.assert_array_equal(skinned, binding.weights)
    assert cutcell.bind(RIG, 16, graph=again.graph).graph is again.graph
    cutcell.explain(RIG, 0, 16, distances=again.distances)


@pytest.mark.slow
@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_processes_bind(method):
    with multiprocessing.get_context(method).Pool(2) as pool:
        for binding in pool.map(bind, [RIG, RIG]):
            np.testing.assert_array_equal(binding.weights, bind(RIG).weights)
