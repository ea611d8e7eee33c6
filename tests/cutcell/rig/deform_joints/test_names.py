"""What names of joints say, in the conventions of many programs."""

import pytest

from cutcell.rig.deform_joints import names


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("mixamorig:HeadTop_End_06", ["head", "top", "end"]),
        ("Bip01 L Toe0Nub", ["bip", "l", "toe", "nub"]),
        ("kneeIK.l", ["knee", "ik", "l"]),
        ("rig|DEF-upper_arm.L.001", ["def", "upper", "arm", "l"]),
        ("IKBackLeg", ["ik", "back", "leg"]),
        ("头", []),
        ("", []),
    ],
)
def test_a_name_is_split_into_words(name, expected):
    assert names.words(name) == expected


@pytest.mark.parametrize(
    ("tell", "yes", "no"),
    [
        (
            names.is_end_marker,
            ["LeftToe_End", "HeadEnd", "Bip01 HeadNub", "tail_end.006", "End Site", "armEff"],
            ["Bend", "Legend", "spine", "endo_arm", "Hub"],
        ),
        (
            names.is_fingertip,
            ["index-finger-tip", "Thumb_Tip_L", "mixamorig:LeftHandIndex4"],
            ["wing_tip_L", "tail_tip", "Index4.L", "LeftHandIndex3"],
        ),
        (
            names.is_control,
            ["PoleTarget.L", "r-LEGCONTROL", "Ctrl_Tail", "l-ARMORIENT", "control-heel-roll.l"],
            ["LeftForeArmRoll", "polevault", "Hips", "mandible", "LeftArm"],
        ),
        (names.may_be_control, ["IK-foot.l", "LeftFootIK", "Weapon.R"], ["bike", "Wrist"]),
        (names.is_socket, ["handslot.r", "socket_hat", "Attach_Sword"], ["Hand"]),
        (names.is_root, ["Root", "MASTER", "Armature"], ["Hips", "Main1"]),
    ],
)
def test_words_tell_what_a_joint_is(tell, yes, no):
    assert [name for name in yes if not tell(name)] == []
    assert [name for name in no if tell(name)] == []
