"""Weight that is suspicious without a truth: planted, found, named, and posed to be seen."""

import json
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import Skeleton
from cutcell.diagnosis import Pose
from cutcell.pose import linear_blend_skinning, rotate_joint
from cutcell_assets import demo_path
from tests.cutcell.diagnosis.worm import worm

WORM = worm()
BIPED = cutcell.load(demo_path("biped"))


def soldier() -> cutcell.Rig:
    """Give the biped a control at its knees that holds a stray 0.03 % of the weight."""
    legs = [BIPED.skeleton.names.index(f"thigh.{side}") for side in "LR"]
    joints, parents = BIPED.skeleton.joints, BIPED.skeleton.parents
    place = joints[legs].mean(axis=0)
    place[0] = joints[legs[0], 0]  # in the trousers
    skeleton = Skeleton(np.vstack([joints, place]), [*parents, -1], [*BIPED.skeleton.names, "Root"])
    weights = np.hstack([BIPED.weights, np.zeros((len(BIPED.weights), 1))])
    near = np.argsort(np.linalg.norm(BIPED.mesh.vertices - place, axis=1))[:30]
    stray = 3e-4 * len(weights) / len(near)
    weights[near] *= 1 - stray
    weights[near, -1] = stray
    return replace(BIPED, skeleton=skeleton, weights=weights, clips=(), source=None)


@pytest.mark.slow
def test_a_control_with_a_stray_part_of_the_weight_is_found():
    rig = soldier()
    control = len(rig.skeleton.joints) - 1
    assert rig.weights[:, control].mean() == pytest.approx(3e-4)
    binding = cutcell.bind(rig, 32)
    assert binding.weights[:, control].mean() > 0.01, "what makes it a fault"
    finding = cutcell.diagnose(rig, 32, distances=binding.distances)["stray-weights"]
    assert finding.severity == "warning"
    assert finding.joints.tolist() == [control]
    assert np.array_equal(finding.vertices, np.flatnonzero(rig.weights[:, control]))
    assert finding.pose.joint == control
    assert finding.details[0].startswith("Root: 0.03")
    assert json.loads(json.dumps(finding.to_dict()))["pose"]["joint"] == control


@pytest.mark.slow
def test_without_it_nothing_is_suspicious():
    assert {f.code for f in cutcell.diagnose(BIPED, 32).findings} <= {"thin-parts"}


def test_an_island_is_found_and_torn_edges_are_seen_in_the_pose_that_is_named():
    weights = WORM.weights.copy()
    island = np.flatnonzero(WORM.mesh.vertices[:, 0] > 0.93)
    weights[island] = 0
    weights[island, 1] = 1.0  # the head follows the tail
    result = cutcell.diagnose(WORM.with_weights(weights), 24)
    finding = result["weight-islands"]
    assert finding.joints.tolist() == [1]
    assert np.isin(finding.vertices, island).all()
    assert len(finding.vertices) >= len(island) / 2
    torn = result["stretched-edges"]
    assert isinstance(torn.pose, Pose)
    turned = rotate_joint(WORM.skeleton, torn.pose.joint, torn.pose.axis, torn.pose.degrees)
    posed = linear_blend_skinning(WORM.mesh.vertices, weights, turned)
    edges = WORM.mesh.faces[:, [0, 1]]
    rest, now = (
        np.linalg.norm(np.diff(p[edges], axis=1)[:, 0], axis=1) for p in (WORM.mesh.vertices, posed)
    )
    assert (now / rest).max() > 2
    assert np.isin(torn.vertices, np.flatnonzero(WORM.mesh.vertices[:, 0] > 0.7)).all()


def test_faces_that_flip_and_volume_that_is_lost_are_found():
    rng = np.random.default_rng(2)
    weights = rng.dirichlet(np.full(7, 0.2), len(WORM.mesh.vertices))
    result = cutcell.diagnose(WORM.with_weights(weights), 24)
    assert len(result["flipped-faces"].faces) > 10
    assert result["flipped-faces"].pose.degrees in (-45, 45)
    half = np.zeros_like(weights)
    half[:, 0], half[:, 3] = 0.5, 0.5  # all of the body half way between two joints
    result = cutcell.diagnose(WORM.with_weights(half), 24)
    assert result["lost-volume"].joints.tolist()


def test_left_and_right_that_differ_are_found():
    vertices = WORM.mesh.vertices - [0.5, 0, 0]
    mesh = cutcell.TriangleMesh(
        np.vstack([vertices, vertices * [-1, 1, 1]]),
        np.vstack([WORM.mesh.faces, WORM.mesh.faces[:, ::-1] + len(vertices)]),
    )
    skeleton = Skeleton([[0, 0, 0], [-0.3, 0, 0], [0.3, 0, 0]], [-1, 0, 0], ["hub", "L", "R"])
    side = np.clip(np.abs(mesh.vertices[:, :1]) / 0.3, 0, 1)
    right = mesh.vertices[:, :1] > 0
    weights = np.hstack([1 - side, side * ~right, side * right])
    rig = cutcell.Rig(mesh, skeleton, weights=weights)
    assert "asymmetric-weights" not in cutcell.diagnose(rig, 24)
    end = mesh.vertices[:, 0] > 0.25
    weights = weights.copy()
    weights[end] = [1, 0, 0]
    finding = cutcell.diagnose(rig.with_weights(weights), 24)["asymmetric-weights"]
    assert finding.severity == "note"
    both = np.flatnonzero(np.abs(mesh.vertices[:, 0]) > 0.25)
    assert np.isin(finding.vertices, both).all()
    assert len(finding.vertices) > 0.9 * len(both)
