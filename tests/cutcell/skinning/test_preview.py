"""What is shown while a joint moves is about what it is bound to in the end."""

import numpy as np
import pytest

import cutcell
from cutcell import Corrections
from cutcell.geodesics.moved import moved_distances
from cutcell.skinning.preview import Preview


@pytest.fixture(scope="module")
def robot(demo_paths):
    return cutcell.load(demo_paths[0].with_name("robot.glb"))


def moved(rig, name, by):
    joints = rig.skeleton.joints.copy()
    joints[rig.skeleton.names.index(name)] += by
    return rig.with_joints(joints)


@pytest.mark.parametrize("options", [{}, {"method": "paper"}, {"connectivity": 6}])
def test_a_preview_is_near_what_is_bound(robot, options):
    method = cutcell.method.method_of(options.get("method", "animation"), 24)
    method = method.with_options(**{k: v for k, v in options.items() if k != "method"})
    binding = cutcell.bind(robot, method=method)
    preview = Preview(robot, binding, method, Corrections())
    np.testing.assert_allclose(preview.bind(robot).weights, binding.weights, rtol=0, atol=1e-9)
    for by in ([0.01, 0.02, 0], [0.03, -0.05, 0.02]):
        other = moved(robot, "forearm.L", by)
        exact = cutcell.bind(other, method=method, graph=binding.graph).weights
        found = preview.bind(other).weights
        np.testing.assert_allclose(found.sum(axis=1), 1)
        off, change = (np.abs(found - exact), np.abs(binding.weights - exact))
        assert change.max() > 0.05
        assert off.mean() < 0.25 * change.mean(), "most of the change is told at once"


def test_distances_along_edges_are_those_of_a_measurement_from_all_joints(robot):
    method = cutcell.ANIMATION.with_options(connectivity=6, resolution=24, leaf="point")
    binding = cutcell.bind(robot, method=method)
    other = moved(robot, "forearm.L", [0.02, 0.03, 0]).skeleton
    within = method.reach_needed
    found = moved_distances(binding.distances, other, method, within)
    exact = cutcell.bone_distances(binding.graph, other, method=method)
    reached = exact.fallback == 0  # the others keep the straight distances that they had
    np.testing.assert_allclose(found.joint[:, reached], exact.joint[:, reached], rtol=0, atol=1e-12)
    assert moved_distances(binding.distances, robot.skeleton, method, within) is binding.distances
