"""Skeletons whose joints are added, removed, renamed and reparented by edits."""

import numpy as np
import pytest

import cutcell
from cutcell import Edits, JointEdit, ParameterError, SkeletonError
from cutcell.rig import Rig, Skeleton
from tests.viewers.arm import arm_rig

TIP = JointEdit(added=True, position=(1.3, 0, 0), parent="wrist")


def rig_of(**corrected):
    removed = corrected.pop("removed", ())
    return cutcell.edited_rig(arm_rig(), Edits(joints=corrected, removed=removed))


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
    rig = rig_of(bend=JointEdit(was="elbow", position=(0.2, 0, 0)))
    assert rig.skeleton.names == ("shoulder", "bend", "wrist")
    assert rig.skeleton.joints[1].tolist() == [0.2, 0, 0]
    np.testing.assert_array_equal(rig.weights, arm_rig().weights)
    swapped = rig_of(elbow=JointEdit(was="wrist"), wrist=JointEdit(was="elbow"))
    assert swapped.skeleton.names == ("shoulder", "wrist", "elbow")


def test_a_joint_is_reparented_and_moves_against_its_parent_as_it_did():
    own, rig = arm_rig(), rig_of(wrist=JointEdit(parent="shoulder"))
    assert rig.skeleton.parents.tolist() == [-1, 0, 0]
    before, now = own.clips[0].sample(1.0), rig.clips[0].sample(1.0)
    local = np.linalg.inv(before[1]) @ before[2]
    np.testing.assert_allclose(now[2], before[0] @ local, atol=1e-12)
    free = rig_of(wrist=JointEdit(parent=""))
    assert free.skeleton.parents.tolist() == [-1, 0, -1]


def test_it_is_done_once():
    edits = Edits({"tip": TIP, "bend": JointEdit(was="elbow")})
    once = cutcell.edited_rig(arm_rig(), edits)
    twice = cutcell.edited_rig(once, edits)
    assert twice.skeleton.names == once.skeleton.names
    a = cutcell.bind(arm_rig(), 16, edits=edits)
    b = cutcell.bind(once, 16, edits=edits)
    np.testing.assert_array_equal(a.weights, b.weights)


def test_orientations_and_skins_go_along():
    own = arm_rig()
    axes = np.stack([np.eye(3), np.eye(3)[[1, 2, 0]], np.eye(3)[[2, 0, 1]]])
    skeleton = Skeleton(own.skeleton.joints, own.skeleton.parents, own.skeleton.names, None, axes)
    allowed = np.ones((len(own.mesh.vertices), 3), bool)
    allowed[:5, 2] = False
    rig = Rig(own.mesh, skeleton, allowed=allowed)
    made = cutcell.edited_rig(rig, Edits({"tip": TIP}, removed=["shoulder"]))
    np.testing.assert_array_equal(made.skeleton.orientations, axes[[1, 2, 2]])
    np.testing.assert_array_equal(made.allowed, allowed[:, [1, 2, 2]])


def test_a_mesh_without_a_skeleton_gets_one():
    bare = Rig(arm_rig().mesh, Skeleton([], []))
    joints = {
        "root": JointEdit(added=True, position=(-1, 0, 0), parent=""),
        "end": JointEdit(added=True, position=(1, 0, 0), parent="root", deform=False),
    }
    rig = cutcell.edited_rig(bare, Edits(joints))
    assert rig.skeleton.parents.tolist() == [-1, 0]
    assert rig.skeleton.deform.tolist() == [True, False]
    assert cutcell.bind(bare, 16, edits=Edits(joints)).weights.shape[1] == 2
    with pytest.raises(ParameterError, match="the mesh has no skeleton"):
        cutcell.edited_rig(bare, Edits({"hip": JointEdit(deform=True)}))


@pytest.mark.parametrize(
    ("corrected", "kind", "says"),
    [
        ({"wrist": TIP}, SkeletonError, 'two joints would be called "wrist"'),
        ({"wrist": JointEdit(was="elbow")}, SkeletonError, 'would be called "wrist"'),
        ({" ": JointEdit(was="elbow")}, SkeletonError, "needs a name"),
        ({"elbow": JointEdit(parent="wrist")}, SkeletonError, "elbow"),
        ({"elbow": JointEdit(parent="knee")}, ParameterError, 'hang on "knee"'),
        ({"arm": JointEdit(was="knee")}, ParameterError, 'no joint "knee"'),
        ({"removed": ["knee"]}, ParameterError, 'no joint "knee"'),
        ({"removed": ["shoulder", "elbow", "wrist"]}, SkeletonError, "no joint of the skel"),
        (
            {"bend": JointEdit(was="elbow"), "removed": ["elbow"]},
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
def test_edits_that_are_none_are_refused(made, says):
    with pytest.raises(ParameterError, match=says):
        JointEdit(**made)


@pytest.mark.parametrize(
    ("removed", "says"), [("elbow", "list of names"), ([3], "names of joints")]
)
def test_what_is_removed_is_a_list_of_names(removed, says):
    with pytest.raises(ParameterError, match=says):
        Edits(removed=removed)


def test_the_structure_is_kept_as_json():
    made = Edits(
        {"tip": TIP, "bend": JointEdit(was="elbow", parent="")}, removed=["wrist", "wrist"]
    )
    assert made.structural
    assert Edits(removed=["wrist"]).structural
    assert not Edits({"elbow": JointEdit(deform=False)}).structural
    assert Edits.from_json(made.to_json()) == made
    assert made.removed == ("wrist",)


def test_the_same_edits_change_nothing_again():
    edits = Edits(joints={"tip": TIP}, removed=["elbow"])
    rig = cutcell.edited_rig(arm_rig(), edits)
    again = cutcell.edited_rig(rig, edits)
    assert again.skeleton.names == rig.skeleton.names
    np.testing.assert_array_equal(again.weights, rig.weights)
    assert cutcell.bind(rig, 16, edits=edits).weights.shape[1] == 3


@pytest.mark.parametrize(
    "edits",
    [
        Edits(removed=["wrist"]),
        Edits(removed=["nobody"]),
        Edits(joints={"tip": TIP}, removed=["elbow", "nobody"]),
        Edits(joints={"bend": JointEdit(was="nobody")}),
        Edits(joints={"tip": TIP}),
        Edits(joints={"tip": TIP, "wrist": JointEdit(parent="tip")}, removed=["elbow"]),
        Edits(joints={"other": TIP}, removed=["elbow"]),
    ],
)
def test_other_edits_of_an_edited_rig_are_refused(edits):
    rig = rig_of(tip=TIP, removed=["elbow"])
    with pytest.raises((ParameterError, SkeletonError)):
        cutcell.edited_rig(rig, edits)
