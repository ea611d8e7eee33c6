"""Transfer of weights to clothes and levels of detail."""

import numpy as np
import pytest

import cutcell
from tests.bars import bar


@pytest.fixture(scope="module")
def body():
    rig = bar(20)
    return rig.with_weights(cutcell.bind(rig, 16).weights)


def shell(rig, factor=1.1):
    """Return the mesh of a bar, thicker."""
    middle = np.array([0.5, 0.1, 0.1])
    around = (rig.mesh.vertices - middle) * [1, factor, factor] + middle
    return cutcell.TriangleMesh(around, rig.mesh.faces)


def test_a_mesh_gets_its_own_weights_back(body):
    result = cutcell.transfer(body, body.mesh)
    assert np.abs(result.weights - body.weights).max() < 1e-12
    assert result.report["matched"] == len(body.mesh.vertices)


def test_a_shell_follows_the_points_below_it(body):
    result = cutcell.transfer(body, shell(body))
    assert np.abs(result.weights - body.weights).max() < 0.01


def test_several_targets_get_what_each_gets_alone(body):
    alone = cutcell.transfer(body, shell(body))
    for one in cutcell.transfer(body, [shell(body), shell(body)]):
        assert np.abs(one.weights - alone.weights).max() < 1e-12
