"""What is shown while a joint moves is about what it is bound to in the end."""

import numpy as np
import pytest
import trimesh

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from cutcell_app.editing.compute.moved_distances import MovedDistances
from cutcell_app.editing.compute.preview import Preview


@pytest.fixture(scope="module")
def robot(demo_paths):
    return cutcell.load(demo_paths[0].with_name("robot.glb"))


def moved(rig, name, by):
    joints = rig.skeleton.joints.copy()
    joints[rig.skeleton.names.index(name)] += by
    return rig.with_joints(joints)


UNSEEN = 2e-5
"""A mean difference of weights that no eye sees."""


@pytest.mark.parametrize("options", [{}, {"method": "paper"}, {"connectivity": 6}])
def test_a_preview_is_near_what_is_bound(robot, options):
    method = cutcell.method.method_of(options.get("method", "animation"), 24)
    method = method.with_options(**{k: v for k, v in options.items() if k != "method"})
    binding = cutcell.bind(robot, method=method)
    preview = Preview(robot, binding, method)
    np.testing.assert_allclose(preview.bind(robot).weights, binding.weights, rtol=0, atol=1e-9)
    for by in ([0.01, 0.02, 0], [0.03, -0.05, 0.02]):
        other = moved(robot, "forearm.L", by)
        exact = cutcell.bind(other, method=method, graph=binding.graph).weights
        found = preview.bind(other).weights
        np.testing.assert_allclose(found.sum(axis=1), 1)
        off, change = (np.abs(found - exact), np.abs(binding.weights - exact))
        assert change.max() > 0.05
        assert off.mean() < 0.25 * change.mean() + UNSEEN, "most of the change is seen at once"


def test_distances_along_edges_are_those_of_a_measurement_from_all_joints(robot):
    method = cutcell.ANIMATION.with_options(connectivity=6, resolution=24, leaf="point")
    binding = cutcell.bind(robot, method=method)
    other = moved(robot, "forearm.L", [0.02, 0.03, 0]).skeleton
    measured = MovedDistances(binding.distances, method, method.reach_needed)
    found = measured.measure(other)
    exact = cutcell.bone_distances(binding.graph, other, method=method)
    reached = exact.fallback == 0  # the others keep the straight distances that they had
    np.testing.assert_allclose(found.joint[:, reached], exact.joint[:, reached], rtol=0, atol=1e-12)
    assert measured.measure(robot.skeleton) is binding.distances


def test_approximate_distances_are_not_taken_for_exact_ones(robot):
    method = cutcell.ANIMATION.with_options(resolution=24)
    binding = cutcell.bind(robot, method=method)
    other = moved(robot, "forearm.L", [0.02, 0.03, 0])
    distances = Preview(robot, binding, method).bind(other).distances
    for use in (cutcell.explain, cutcell.diagnose):
        vertex = [0] if use is cutcell.explain else []
        with pytest.raises(cutcell.ParameterError, match="approximate"):
            use(other, *vertex, 24, distances=distances)


def test_a_part_keeps_the_only_joint_that_reaches_it():
    box = trimesh.creation.box((1, 1, 1)).subdivide().subdivide()
    mesh = trimesh.util.concatenate([box, box.copy().apply_translation([3, 0, 0])])
    joints = [[0, 0, 0], [3, 0, 0]]
    rig = Rig(TriangleMesh(mesh.vertices, mesh.faces), Skeleton(joints, [-1, -1]))
    binding = cutcell.bind(rig, 24)
    preview = Preview(rig, binding, cutcell.ANIMATION.with_options(resolution=24))
    weights = preview.bind(rig.with_joints([[0, 0, 0], [0.2, 0, 0]])).weights
    np.testing.assert_allclose(weights[len(box.vertices) :], np.tile([0.0, 1.0], (98, 1)))
