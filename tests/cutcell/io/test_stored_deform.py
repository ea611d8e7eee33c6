"""Which joints deform is stored in saved files: joints that got no weight still deform."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import cutcell
from cutcell.editing import edited_rig
from cutcell.io.gltf.container import read_document
from tests.cutcell.io.fbx_builder import binary, column_scene
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, column, two_skins
from tests.cutcell.io.gltf.test_bare import bare
from tests.cutcell.io.test_articulation import write
from tests.gltf_validator.validator import errors, reports

KEY = "cutcell_deform"


def three_joints():
    """Return a new rig of which one joint that deforms has no weight, and one does not deform."""
    skeleton = cutcell.Skeleton(
        [*REST, [0.5, 2, 0.5]], [-1, 0, 1], list("abc"), [False, True, True]
    )
    weights = np.tile([0.0, 1, 0], (len(COLUMN), 1))
    return cutcell.Rig(cutcell.TriangleMesh(COLUMN, FACES), skeleton, weights)


def of_column(path, builder=None):
    """Return the column, bound to one joint while both deform."""
    rig = cutcell.load((builder or column()).save(path))
    return rig.with_weights(np.eye(len(rig.skeleton.joints))[np.ones(len(rig.mesh.vertices), int)])


def of_bare(path):
    rig, three = cutcell.load(bare().save(path)), three_joints()
    return replace(rig, skeleton=three.skeleton, weights=three.weights)


def of_fbx(path):
    path.with_suffix(".fbx").write_bytes(binary(column_scene()))
    rig = cutcell.load(path.with_suffix(".fbx"))
    return rig.with_weights(np.eye(len(rig.skeleton.joints))[np.ones(len(rig.mesh.vertices), int)])


def with_a_joint_added(path):
    added = cutcell.JointEdit(added=True, position=(0.5, 2, 0.5), parent="tip")
    return edited_rig(of_column(path), cutcell.Edits({"end": added}))


@pytest.mark.parametrize(
    "source",
    [
        lambda path: three_joints(),
        of_column,
        lambda path: of_column(path, two_skins([3, 0, -2])),
        of_bare,
        of_fbx,
        with_a_joint_added,
    ],
    ids=["new", "column", "skins", "bare", "fbx", "added"],
)
@pytest.mark.parametrize("end", [".glb", ".gltf", ".npz"])
def test_joints_without_weight_still_deform(tmp_path, source, end):
    rig = source(tmp_path / "source.glb")
    assert (rig.skeleton.deform & ~rig.weights.any(axis=0)).any()
    cutcell.save(tmp_path / f"out{end}", rig)
    again = cutcell.load(tmp_path / f"out{end}")
    assert_array_equal(again.skeleton.deform, rig.skeleton.deform)
    if end != ".npz":
        assert errors(*reports(tmp_path / f"out{end}")) == {}


def test_weights_do_not_change_what_is_stored(tmp_path):
    rig = three_joints()
    cutcell.save(tmp_path / "a.glb", rig)
    other = cutcell.load(tmp_path / "a.glb")
    glued = other.with_weights(np.tile([1.0, 0, 0], (len(COLUMN), 1)))
    cutcell.save(tmp_path / "b.glb", glued)
    again = cutcell.load(tmp_path / "b.glb")
    assert_array_equal(again.skeleton.deform, rig.skeleton.deform)
    (warning,) = again.warnings
    assert warning.startswith("a ")


@pytest.mark.parametrize(
    "flags",
    [
        [True],
        [True, False, True],
        [1, 0],
        ["yes", "no"],
        None,
        5,
        {},
        [[True], [False]],
        [2**70, -1],
    ],
)
def test_a_list_that_does_not_fit_is_ignored_with_a_warning(loaded, flags):
    builder = column()
    builder.json["skins"][0]["extras"] = {KEY: flags}
    rig = loaded(builder)
    assert rig.skeleton.deform.all()
    assert len(rig.warnings) == 1


@pytest.mark.parametrize("extras", [None, 5, "text", [], {}, {"deform": [False, True]}])
def test_extras_of_others_stay(loaded, tmp_path, extras):
    builder = column()
    builder.json["skins"][0]["extras"] = extras
    rig = loaded(builder)
    assert rig.skeleton.deform.all()
    assert rig.warnings == ()
    cutcell.save(tmp_path / "out.glb", rig)
    (skin,) = read_document(tmp_path / "out.glb").json["skins"]
    if isinstance(extras, dict):
        extras = {**extras, KEY: [True, True]}
    assert skin["extras"] == extras


def test_where_no_joint_would_deform_the_weights_say_which(loaded):
    builder = column()
    builder.json["skins"][0]["extras"] = {KEY: [False, False]}
    assert loaded(builder).skeleton.deform.all()


def test_a_skin_of_another_program_goes_by_its_weights(loaded):
    builder = two_skins([0, 0, 3], shared=False)
    builder.json["skins"][0]["extras"] = {KEY: [True, False]}
    assert loaded(builder).skeleton.deform.tolist() == [True, False, True, True]


@pytest.mark.parametrize(
    "stored", [np.array([True]), np.array([1, 0]), np.array("x"), np.ones((2, 2), bool)]
)
def test_an_array_that_does_not_fit_is_ignored_with_a_warning(tmp_path, stored):
    rig = cutcell.load(write(tmp_path, cutcell_deform=stored))
    assert rig.skeleton.deform.all()
    assert len(rig.warnings) == 1
