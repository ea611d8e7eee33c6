"""What names of joints say, in the conventions of many programs."""

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
        ("头", []),
        ("左足ＩＫ", ["ik"]),
        ("ＬｅｇＩＫ＿Ｌ", ["leg", "ik", "l"]),
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
            names.is_end_marker,
            ["左手先", "人指先_L", "ｾﾝﾀｰ先", "髪先.001", "ＨｅａｄＥｎｄ"],
            ["左つま先", "爪先.L", "左足先EX"],
        ),
        (
            names.is_control,
            ["全ての親", "センター", "ｾﾝﾀｰ", "センター先", "グルーブ", "ｸﾞﾙｰﾌﾞ", "操作中心"],
            ["前髪センター", "上半身"],
        ),
        (
            names.is_control,
            ["左ダミー", "neutral_bone", "neutral_bone (2)", "Ｃｔｒｌ"],
            ["neutral", "bone_neutral_pose"],
        ),
        (
            names.is_fingertip,
            ["index-finger-tip", "Thumb_Tip_L", "mixamorig:LeftHandIndex4", "LeftHandThumb４"],
            ["wing_tip_L", "tail_tip", "Index4.L", "LeftHandIndex3"],
        ),
        (
            names.is_control,
            ["PoleTarget.L", "r-LEGCONTROL", "Ctrl_Tail", "l-ARMORIENT", "control-heel-roll.l"],
            ["LeftForeArmRoll", "polevault", "Hips", "mandible", "LeftArm"],
        ),
        (
            names.may_be_control,
            ["IK-foot.l", "LeftFootIK", "Weapon.R", "左足ＩＫ", "腰キャンセル", "左肩Ｐ"],
            ["bike", "Wrist", "左肩", "左足首"],
        ),
        (
            names.is_of_mmd,
            ["全ての親", "下半身", "UpperBody2", "lower body", "ParentNode", "johanshin"],
            ["J_Bip_C_UpperChest", "upperarm", "body", "Parent"],
        ),
        (
            names.is_mmd_control,
            ["ParentNode", "center", "groove", "view cnt", "center_tip", "mother", "sentaa"],
            ["tip_L", "upper body", "hair center", "腕", ""],
        ),
        (
            names.is_mmd_tip,
            ["hand tip_L", "LeftHandTip", "UpperBodyTip", "kubi saki"],
            ["LegTipEX_L", "hair tip", "tip of nose"],
        ),
        (names.is_socket, ["handslot.r", "socket_hat", "Attach_Sword"], ["Hand"]),
        (names.is_root, ["Root", "MASTER", "Armature"], ["Hips", "Main1"]),
    ],
)
def test_words_tell_what_a_joint_is(tell, yes, no):
    assert [name for name in yes if not tell(name)] == []
    assert [name for name in no if tell(name)] == []
