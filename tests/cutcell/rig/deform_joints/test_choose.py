"""A person says which joints deform, by name."""

from dataclasses import replace

import numpy as np
import pytest

from cutcell import ParameterError, Rig, Skeleton, TriangleMesh, choose_deform
from tests.bars import grid_box

NAMES = ("Root", "Arm.L", "Arm.R", "Hand_IK", "Arm*")


def rig(deform=(True, True, True, False, False)):
    joints = [[x, 0.1, 0.1] for x in (0.1, 0.3, 0.5, 0.7, 0.9)]
    joints[NAMES.index("Hand_IK")][2] = 0.9  # in the air
    skeleton = Skeleton(joints, [-1, 0, 1, 2, 3], NAMES, deform)
    mesh = TriangleMesh(*grid_box(10))
    weights = np.zeros((len(mesh.vertices), 5))
    weights[:, 0] = 1
    return Rig(mesh, skeleton, weights)


def chosen(*args, **kwargs):
    result = choose_deform(rig(), *args, **kwargs).skeleton
    return {name for name, deform in zip(result.names, result.deform, strict=True) if deform}


def test_names_and_patterns():
    assert chosen() == {"Root", "Arm.L", "Arm.R"}
    assert chosen(["hand_ik"]) == {"Root", "Arm.L", "Arm.R", "Hand_IK"}
    assert chosen(no_deform=["ARM.?"]) == {"Root"}
    assert chosen(["*"], ["*_IK", "root"]) == {"Arm.L", "Arm.R", "Arm*"}
    # A name that holds a star means the joint of that name.
    assert chosen(["Arm*"]) == {"Root", "Arm.L", "Arm.R", "Arm*"}


def test_names_are_compared_as_people_read_them():
    skeleton = replace(rig().skeleton, names=("全ての親", "左足ＩＫ", "Ｒｏｏｔ", "ｾﾝﾀｰ", "Arm"))
    some = replace(rig(), skeleton=skeleton)
    assert choose_deform(some, ["センター"]).skeleton.deform.tolist() == [1, 1, 1, 1, 0]
    without = choose_deform(some, no_deform=["root", "*ik"])
    assert without.skeleton.deform.tolist() == [1, 0, 0, 0, 0]


def test_the_file_can_be_forgotten():
    fresh = choose_deform(rig(), fresh=True)
    assert fresh.weights is None
    assert not fresh.skeleton.deform[NAMES.index("Hand_IK")]
    assert fresh.skeleton.deform[NAMES.index("Arm*")]
    renamed = choose_deform(replace(rig(), name="other"), fresh=True)
    assert np.array_equal(renamed.skeleton.deform, fresh.skeleton.deform)
    assert choose_deform(rig()).weights is not None
    bare = replace(rig(), skeleton=Skeleton([], []), weights=None)
    assert len(choose_deform(bare, fresh=True).skeleton.joints) == 0


def test_wrong_names_are_told():
    with pytest.raises(ParameterError, match=r'no joint is called "Arm.X"; did you mean Arm.R'):
        chosen(["Arm.X"])
    with pytest.raises(ParameterError, match=r'no joint is called "zzz"$'):
        chosen(no_deform=["zzz"])
    with pytest.raises(ParameterError, match="no joint is left"):
        chosen(no_deform=["*"])
