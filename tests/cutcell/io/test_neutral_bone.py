"""Blender's stand-in for vertices without weights is no bone."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from tests.cutcell.io.gltf.gltf_builder import JOINTS, REST, SHARES, column, moved


def with_neutral(held, name="neutral_bone", extras=None):
    """Return a column whose third joint, at the origin, holds some vertices."""
    builder = column()
    joints, shares = JOINTS.copy(), SHARES.copy()
    joints[held], shares[held] = [2, 0, 0, 0], [1, 0, 0, 0]
    builder.json["nodes"].append({"name": name})
    (skin,) = builder.json["skins"]
    skin["joints"].append(len(builder.json["nodes"]) - 1)
    builder.json["scenes"][0]["nodes"].append(skin["joints"][-1])
    inverse = [moved(*-at) for at in REST] + [np.eye(4)]
    skin["inverseBindMatrices"] = builder.accessor(np.array(inverse))
    attributes = builder.json["meshes"][0]["primitives"][0]["attributes"]
    attributes |= {"JOINTS_0": builder.accessor(joints), "WEIGHTS_0": builder.accessor(shares)}
    if extras is not None:
        skin["extras"] = extras
    return builder


@pytest.mark.parametrize("name", ["neutral_bone", "Neutral_Bone", "neutral_bone.001"])
@pytest.mark.parametrize("extras", [None, {"cutcell_deform": [True, True, True]}])
def test_its_vertices_count_as_without_weight(loaded, name, extras):
    rig = loaded(with_neutral([1, 2, 3, 7], name, extras))
    assert rig.skeleton.deform.tolist() == [True, True, False]
    assert not rig.weights[:, 2].any()
    assert_array_equal(np.flatnonzero(rig.weights.sum(axis=1) == 0), [1, 2, 3, 7])
    (warning,) = rig.warnings
    assert warning.startswith("4 of 12 vertices")
    assert name in warning


def test_they_are_bound_anew(loaded):
    rig = loaded(with_neutral([1, 2, 3, 7]))
    weights = cutcell.bind(rig, resolution=16).weights
    assert not weights[:, 2].any()
    assert_allclose(weights.sum(axis=1), 1)


def test_a_diagnosis_lists_them_and_a_repair_gives_them_weights(loaded):
    result = cutcell.diagnose(loaded(with_neutral([1, 2, 3, 7])), 16)
    assert_array_equal(result["unweighted-vertices"].vertices, [1, 2, 3, 7])
    repaired = result.repaired(["unweighted-vertices"]).rig
    assert_allclose(repaired.weights.sum(axis=1), 1)
    assert not repaired.weights[:, 2].any()


def test_without_any_other_weight_names_and_places_say_which_joints_deform(loaded):
    rig = loaded(with_neutral(list(range(12))))
    assert rig.skeleton.deform.tolist() == [True, True, False]
    assert any(warning.startswith("12 of 12 vertices") for warning in rig.warnings)


def test_where_it_holds_nothing_nothing_is_said(loaded):
    rig = loaded(with_neutral([]))
    assert rig.skeleton.deform.tolist() == [True, True, False]
    assert rig.warnings == ()


def test_a_new_skeleton_gives_it_no_weight():
    joints = [[0, 0, 0], [1, 0, 0]]
    names = ["a", "neutral_bone"]
    skeleton = cutcell.Skeleton(joints, [-1, -1], names)
    assert skeleton.deform.tolist() == [True, False]
    assert replace(skeleton, deform=[True, True]).deform.all()
    assert cutcell.Skeleton(joints[:1], [-1], names[1:]).deform.all()
