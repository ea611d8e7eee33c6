"""Skeletons whose joints are added, removed, renamed and reparented by corrections."""

import numpy as np
import pytest

import cutcell
from cutcell import Corrections, JointCorrection, ParameterError, SkeletonError
from cutcell.rig import Rig, Skeleton
from tests.viewers.arm import arm_rig

TIP = JointCorrection(added=True, position=(1.3, 0, 0), parent="wrist")


def rig_of(**corrected):
    removed = corrected.pop("removed", ())
    return cutcell.corrected_rig(arm_rig(), Corrections(joints=corrected, removed=removed))


def test_a_joint_is_added():
    rig = rig_of(tip=TIP)
    assert rig.skeleton.names == ("shoulder", "elbow", "wrist", "tip")
    assert rig.skeleton.parents.tolist() == [-1, 0, 1, 2]
    assert rig.origin.tolist() == [0, 1, 2, -1]
    assert not rig.weights[:, 3].any()
    moved = rig.clips[0].sample(1.0)
    np.testing.assert_allclose(moved[3], moved[2])
    assert cutcell.bind(rig, 16).weights[:, 3].max() > 0.5


def test_a_joint_is_removed_and_its_children_go_to_its_parent():
    own, rig = arm_rig(), rig_of(removed=["elbow"])
    assert rig.skeleton.names == ("shoulder", "wrist")
    assert rig.skeleton.parents.tolist() == [-1, 0]
    np.testing.assert_allclose(rig.weights[:, 0], own.weights[:, :2].sum(axis=1))
    assert rig.attachments[0].joint == 1
    np.testing.assert_allclose(rig.clips[0].sample(1.0), np.tile(np.eye(4), (2, 1, 1)), atol=1e-12)


def test_a_root_is_removed():
    own, rig = arm_rig(), rig_of(removed=["shoulder"])
    assert rig.skeleton.parents.tolist() == [-1, 0]
    np.testing.assert_allclose(rig.weights[:, 0], own.weights[:, :2].sum(axis=1))
    np.testing.assert_allclose(rig.clips[0].sample(1.0), own.clips[0].sample(1.0)[1:])


def test_a_joint_is_renamed_and_corrected_by_its_new_name():
    rig = rig_of(bend=JointCorrection(was="elbow", position=(0.2, 0, 0)))
    assert rig.skeleton.names == ("shoulder", "bend", "wrist")
    assert rig.skeleton.joints[1].tolist() == [0.2, 0, 0]
    np.testing.assert_array_equal(rig.weights, arm_rig().weights)
    swapped = rig_of(elbow=JointCorrection(was="wrist"), wrist=JointCorrection(was="elbow"))
    assert swapped.skeleton.names == ("shoulder", "wrist", "elbow")


def test_a_joint_is_reparented_and_moves_against_its_parent_as_it_did():
    own, rig = arm_rig(), rig_of(wrist=JointCorrection(parent="shoulder"))
    assert rig.skeleton.parents.tolist() == [-1, 0, 0]
    before, now = own.clips[0].sample(1.0), rig.clips[0].sample(1.0)
    local = np.linalg.inv(before[1]) @ before[2]
    np.testing.assert_allclose(now[2], before[0] @ local, atol=1e-12)
    free = rig_of(wrist=JointCorrection(parent=""))
    assert free.skeleton.parents.tolist() == [-1, 0, -1]


def test_it_is_done_once():
    corrections = Corrections({"tip": TIP, "bend": JointCorrection(was="elbow")})
    once = cutcell.corrected_rig(arm_rig(), corrections)
    twice = cutcell.corrected_rig(once, corrections)
    assert twice.skeleton.names == once.skeleton.names
    a = cutcell.bind(arm_rig(), 16, corrections=corrections)
    b = cutcell.bind(once, 16, corrections=corrections)
    np.testing.assert_array_equal(a.weights, b.weights)


def test_orientations_and_skins_go_along():
    own = arm_rig()
    axes = np.stack([np.eye(3), np.eye(3)[[1, 2, 0]], np.eye(3)[[2, 0, 1]]])
    skeleton = Skeleton(own.skeleton.joints, own.skeleton.parents, own.skeleton.names, None, axes)
    allowed = np.ones((len(own.mesh.vertices), 3), bool)
    allowed[:5, 2] = False
    rig = Rig(own.mesh, skeleton, allowed=allowed)
    made = cutcell.corrected_rig(rig, Corrections({"tip": TIP}, removed=["shoulder"]))
    np.testing.assert_array_equal(made.skeleton.orientations, axes[[1, 2, 2]])
    np.testing.assert_array_equal(made.allowed, allowed[:, [1, 2, 2]])


def test_a_mesh_without_a_skeleton_gets_one():
    bare = Rig(arm_rig().mesh, Skeleton([], []))
    joints = {
        "root": JointCorrection(added=True, position=(-1, 0, 0), parent=""),
        "end": JointCorrection(added=True, position=(1, 0, 0), parent="root", deform=False),
    }
    rig = cutcell.corrected_rig(bare, Corrections(joints))
    assert rig.skeleton.parents.tolist() == [-1, 0]
    assert rig.skeleton.deform.tolist() == [True, False]
    assert cutcell.bind(bare, 16, corrections=Corrections(joints)).weights.shape[1] == 2
    with pytest.raises(ParameterError, match="the mesh has no skeleton"):
        cutcell.corrected_rig(bare, Corrections({"hip": JointCorrection(gain=2)}))


@pytest.mark.parametrize(
    ("corrected", "kind", "says"),
    [
        ({"wrist": TIP}, SkeletonError, 'two joints would be called "wrist"'),
        ({"wrist": JointCorrection(was="elbow")}, SkeletonError, 'would be called "wrist"'),
        ({" ": JointCorrection(was="elbow")}, SkeletonError, "needs a name"),
        ({"elbow": JointCorrection(parent="wrist")}, SkeletonError, "elbow"),
        ({"elbow": JointCorrection(parent="knee")}, ParameterError, 'hang on "knee"'),
        ({"arm": JointCorrection(was="knee")}, ParameterError, 'no joint "knee"'),
        ({"removed": ["knee"]}, ParameterError, 'no joint "knee"'),
        ({"removed": ["shoulder", "elbow", "wrist"]}, SkeletonError, "no joint of the skel"),
        (
            {"bend": JointCorrection(was="elbow"), "removed": ["elbow"]},
            ParameterError,
            "both remove and rename",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_is_said(corrected, kind, says):
    with pytest.raises(kind, match=says):
        rig_of(**corrected)


@pytest.mark.parametrize(
    ("made", "says"),
    [
        ({"added": True, "parent": ""}, "needs a position and a parent"),
        ({"added": True, "position": (0, 0, 0)}, "needs a position and a parent"),
        ({"added": 1}, "added"),
        ({"parent": 3}, "parent must be the name of a joint"),
        ({"was": 3}, "was must be the name of a joint"),
    ],
)
def test_corrections_that_are_none_are_refused(made, says):
    with pytest.raises(ParameterError, match=says):
        JointCorrection(**made)


@pytest.mark.parametrize(
    ("removed", "says"), [("elbow", "list of names"), ([3], "names of joints")]
)
def test_what_is_removed_is_a_list_of_names(removed, says):
    with pytest.raises(ParameterError, match=says):
        Corrections(removed=removed)


def test_the_structure_is_kept_as_json():
    made = Corrections(
        {"tip": TIP, "bend": JointCorrection(was="elbow", parent="")}, removed=["wrist", "wrist"]
    )
    assert made.structural
    assert Corrections(removed=["wrist"]).structural
    assert not Corrections({"elbow": JointCorrection(gain=2)}).structural
    assert Corrections.from_json(made.to_json()) == made
    assert made.removed == ("wrist",)


def test_the_same_corrections_change_nothing_again():
    corrections = Corrections(joints={"tip": TIP}, removed=["elbow"])
    rig = cutcell.corrected_rig(arm_rig(), corrections)
    again = cutcell.corrected_rig(rig, corrections)
    assert again.skeleton.names == rig.skeleton.names
    np.testing.assert_array_equal(again.weights, rig.weights)
    assert cutcell.bind(rig, 16, corrections=corrections).weights.shape[1] == 3


@pytest.mark.parametrize(
    "corrections",
    [
        Corrections(removed=["wrist"]),
        Corrections(removed=["nobody"]),
        Corrections(joints={"tip": TIP}, removed=["elbow", "nobody"]),
        Corrections(joints={"bend": JointCorrection(was="nobody")}),
        Corrections(joints={"tip": TIP}),
        Corrections(joints={"tip": TIP, "wrist": JointCorrection(parent="tip")}, removed=["elbow"]),
        Corrections(joints={"other": TIP}, removed=["elbow"]),
    ],
)
def test_other_corrections_of_a_corrected_rig_are_refused(corrections):
    rig = rig_of(tip=TIP, removed=["elbow"])
    with pytest.raises((ParameterError, SkeletonError)):
        cutcell.corrected_rig(rig, corrections)
