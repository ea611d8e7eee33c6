"""Names of joints are compared without case, width, sides and name spaces."""

import pytest

from cutcell.rig import names


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("mixamorig:HeadTop_End_06", ["head", "top", "end"]),
        ("Bip01 L Toe0Nub", ["bip", "l", "toe", "nub"]),
        ("kneeIK.l", ["knee", "ik", "l"]),
        ("rig|DEF-upper_arm.L.001", ["def", "upper", "arm", "l"]),
        ("IKBackLeg", ["ik", "back", "leg"]),
        ("IKhand", ["ik", "hand"]),
        ("头", []),
        ("左足ＩＫ", ["ik"]),
        ("ＬｅｇＩＫ＿Ｌ", ["leg", "ik", "l"]),
        ("", []),
    ],
)
def test_a_name_is_split_into_words(name, expected):
    assert names.words(name) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("thumb_end_r_055", ("thumb end 055", "r")),
        ("LeftHandIndex4", ("hand index 4", "l")),
        ("lThighBend", ("thigh bend", "l")),
        ("arm_L0_0_jnt", ("arm 0 0 jnt", "l")),
        ("左足D", ("足 d", "l")),
        ("leg D_L", ("leg d", "l")),
        ("spine_01.x", ("spine 01 x", "")),
        ("épaule.G", ("épaule g", "")),
        ("", ("", "")),
    ],
)
def test_sides_are_parted_from_a_name(name, expected):
    assert names.plain(name) == expected
