"""The learned model corrects shares, whatever the order and the names of a file are."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import Corrections, Rig, Skeleton, TriangleMesh, bind
from cutcell.editing.corrections import JointCorrection, PartCorrection
from cutcell.weights.learned.features import WORDS, word_code
from cutcell.weights.learned.forest import STORED, Forest, stored_forest
from tests.bars import grid_box


def limb():
    vertices, faces = grid_box(20)
    joints = [[x, 0.1, 0.1] for x in (0.05, 0.35, 0.65)]
    return Rig(TriangleMesh(vertices, faces), Skeleton(joints, [-1, 0, 1], ["hip", "knee", "foot"]))


def learned(rig, **options):
    return bind(rig, 24, refine="learned", **options).weights


def test_a_forest_adds_up_the_leaves_that_rows_fall_into(tmp_path):
    # Left of 0.5: 1; else left of 2.5 in the second feature: -1, else 3. The second tree is a leaf.
    forest = Forest(
        np.array([0, 5], np.int32),
        np.array([0, -1, 1, -1, -1, -1], np.int16),
        np.array([0.5, 1.0, 2.5, -1.0, 3.0, 0.25]),
        np.array([2, 0, 4, 0, 0, 0], np.int32),
        -0.5,
    )
    rows = np.array([[0.5, 9], [1, 2.5], [1, 3]], np.float32)
    logit = np.array([0.75, -1.25, 2.75])
    np.testing.assert_allclose(forest.probability(rows), 1 / (1 + np.exp(-logit)))
    forest.save(tmp_path / "forest.npz")
    again = Forest.load(tmp_path / "forest.npz")
    np.testing.assert_array_equal(again.probability(rows), forest.probability(rows))


def test_the_stored_model_is_small_and_whole():
    forest = stored_forest()
    assert STORED.stat().st_size < 1_000_000
    assert forest.right[forest.feature >= 0].min() > 0
    assert np.isfinite(forest.value).all()


def test_rows_sum_to_one_and_differ_from_the_rules():
    rig = limb()
    weights = learned(rig)
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    assert np.abs(weights - bind(rig, 24).weights).max() > 0.01


def test_orders_and_mirroring_do_not_matter():
    rig = limb()
    weights = learned(rig)
    mesh, skeleton = rig.mesh, rig.skeleton
    order = np.random.default_rng(0).permutation(len(mesh.vertices))
    shuffled = TriangleMesh(mesh.vertices[order], np.argsort(order)[mesh.faces])
    np.testing.assert_allclose(learned(Rig(shuffled, skeleton)), weights[order], atol=1e-3)
    joints = [2, 0, 1]
    names = [skeleton.names[j] for j in joints]
    other = Skeleton(skeleton.joints[joints], [2, -1, 1], names)
    np.testing.assert_allclose(learned(Rig(mesh, other)), weights[:, joints], atol=1e-3)
    flip = np.array([1, -1, 1])
    mirrored = TriangleMesh(mesh.vertices * flip, mesh.faces[:, ::-1])
    turned = replace(skeleton, joints=skeleton.joints * flip)
    np.testing.assert_allclose(learned(Rig(mirrored, turned)), weights, atol=0.01)


def test_names_count_by_words_only():
    assert word_code("mixamorig:LeftUpLeg") == word_code("thigh_R.001") > 0
    assert word_code("Bone.003") == word_code("") == 0
    assert len(WORDS) == 13


def test_corrections_hold_on_top():
    rig = limb()
    rig = rig.with_weights(bind(rig, 24).weights)
    corrections = Corrections(joints={"knee": JointCorrection(locked=True)})
    locked = learned(rig, corrections=corrections)
    np.testing.assert_allclose(locked[:, 1], rig.weights[:, 1], atol=1e-9)
    part = Corrections(parts={0: PartCorrection("glued", "foot")})
    np.testing.assert_array_equal(learned(rig, corrections=part)[:, 2], 1)


def test_explain_tells_what_the_model_changed():
    rig = limb()
    vertex = int(np.abs(learned(rig) - bind(rig, 24).weights).max(axis=1).argmax())
    joints = cutcell.explain(rig, vertex, 24, refine="learned").joints
    assert all(list(joint.steps)[:2] == ["falloff", "learned"] for joint in joints)
    assert any(abs(joint.steps["learned"] - joint.steps["falloff"]) > 1e-3 for joint in joints)
    assert joints[0].weight == pytest.approx(learned(rig)[vertex].max())
