"""Each tool's convention says which of its joints deform; elsewhere it says nothing."""

import random

import pytest

from cutcell.rig.deform_joints.conventions import CONVENTIONS, kinds_by_name

HANDS = ("LeftUpLeg", "RightUpLeg", "LeftForeArm", "RightForeArm")
SKELETONS = {
    "Rigify": (
        "DEF-spine DEF-spine.001 DEF-thigh.L DEF-thigh.R DEF-f_index.01.L",
        "ORG-spine MCH-foot_roll.L hand_ik.L torso upper_arm_tweak.L root",
    ),
    "Sketchfab": (
        "DEF-spine_06 DEF-spine001_07 DEF_thigh.L_08",
        "GLTF_created_0_rootJoint ORG-spine_05 MCH_pivot_04 rig_01",
    ),
    "Rigify's meta-rig": (
        "spine spine.001 thigh.L thigh.R shin.L shin.R foot.L toe.L breast.L pelvis.L",
        "heel.02.L heel.02.R",
    ),
    "BlenRig": (
        "pelvis_def spine_1_def thigh_def_L thigh_def_R",
        "master pelvis_ctrl thigh_ik_L spine_mstr arm_fk_L foot_mech_R",
    ),
    "Auto-Rig Pro": (
        "root.x spine_01.x neck.x arm_stretch.l thigh_twist.l hand.l c_thigh_b.l c_ear_01.r "
        "c_skull_01.x c_index2.l c_spine_01_bend.x index1.l forearm_twist.l c_arm_twist_offset.l",
        "c_traj c_pos c_root_master.x arm.l arm_fk.l arm_ik_nostr.l thigh_ref.l c_hand_ik.l "
        "c_arms_pole.l c_spine_01.x c_foot_roll.l arm_scale_fix.l c_eye_target.x c_hand_fk.r "
        "arm_twist.l neck_twist.x hand_rot_twist.l c_toes_index1.l c_root_bend.x foot_heel.l "
        "toes_02.l c_arm_twk.l bend_all.l",
    ),
    "Advanced Skeleton": (
        "Root_M Spine1_M Chest_M Head_M Hip_R Knee_R Ankle_R IndexFinger3_R HipPart1_L Toes_R",
        "HeadEnd_M ToesEnd_R IndexFinger4_R JawEnd_M Heel_R FKXKnee_R",
    ),
    "mGear": (
        "spine_C0_0_jnt spine_C0_1_jnt arm_L0_0_jnt leg_R0_end_jnt",
        "global_C0_0_jnt arm_L0_ik_ctl leg_L0_upv_cns spine_C0_root",
    ),
    "3ds Max' Biped": (
        ["Bip001 Pelvis", "Bip001 Spine", "Bip001 L Thigh", "Bip001 R Calf", "Bip001 Ponytail1"],
        ["Bip001", "Bip001 Footsteps", "Bip001 HeadNub", "Bip001 L Finger0Nub", "Bip001 L Toe0Nub"],
    ),
    "3ds Max' CAT": (
        "CATRigHub001 CATRigLArmCollarbone CATRigLLegPalm CATRigSpine1 CATRigLArmDigit11",
        "CATRigLLegPlatform CATRigRLegPlatform CATParent",
    ),
    "HumanIK and Mixamo": (
        [f"mixamorig:{name}" for name in (*HANDS, "Hips", "LeftHandIndex3", "LeftArmRoll")],
        ["HeadTop_End", "mixamorig:LeftToe_End", "LeftHandIndex4", "Reference"],
    ),
    "HumanIK and Mixamo, from Sketchfab": (
        [f"mixamorig:{name}_0{i}" for i, name in enumerate(HANDS)],
        ["mixamorig:LeftHandThumb4_035", "mixamorig:HeadTop_End_06", "_rootJoint"],
    ),
    "Unreal": (
        "pelvis spine_01 spine_02 clavicle_l upperarm_l lowerarm_l calf_r ball_l calf_twist_01_l",
        ["root", "ik_foot_root", "ik_hand_gun", "VB foot_l", "interaction", "center_of_mass"],
    ),
    "Character Creator": (
        "CC_Base_Hip CC_Base_L_ThighTwist01 CC_Base_L_KneeShareBone CC_Base_JawRoot CC_Base_Head",
        "CC_Base_BoneRoot CC_Base_Pivot",
    ),
    "Daz": (
        "hip pelvis lThighBend lThighTwist rShldrBend abdomenLower lForearmTwist lMetatarsals",
        "Genesis8Female",
    ),
    "SteamVR": (
        "wrist_r finger_thumb_0_r finger_index_meta_r finger_index_0_r",
        "Root finger_index_r_aux finger_thumb_r_end finger_thumb_r_aux_end",
    ),
    "VRM and VRoid": (
        "J_Bip_C_Hips J_Bip_L_UpperArm J_Sec_Hair1_01 J_Adj_L_FaceEye J_Sec_L_Bust1",
        "Root secondary J_Sec_Hair1_01_end HairJoint-end",
    ),
    "MikuMikuDance": (
        "上半身 下半身 首 頭 左足D 左つま先 右腕 右腕捩 前髪センター 左足先EX",
        "全ての親 センター ｾﾝﾀｰ グルーブ ｸﾞﾙｰﾌﾞ 操作中心 左ダミー 左手先 人指先_L 髪先.001 両目 "
        "センター先 左足",
    ),
    "MikuMikuDance, translated": (
        ["UpperBody", "LowerBody", "Neck", "LegTipEX_L", "hair tip", "tip of nose", "leg D.R"],
        ["ParentNode", "Center", "groove", "view cnt", "center_tip", "HeadTip", "leg.R"],
    ),
    "MikuMikuDance, romanised": (
        ["jouhanshin", "kahanshin", "kubi", "tsuma saki_L"],
        ["subete no oya", "sentaa", "kubi saki", "mother"],
    ),
    "MakeHuman": (
        "root2 levator05.L levator06.R oris01 oris05 temporalis03 tongue00",
        "root levator02.L oculi02.R oris04.L risorius02.R special03 temporalis01.L",
    ),
    "all tools": (
        "Bone Bone.001 center tail_tip Index4.L LeftForeArmRoll polevault mandible wing_tip_L Bend "
        "spine endo_arm root parent heel.L muscle",
        "LeftToe_End HeadNub tail_end.006 armEff index-finger-tip Thumb_Tip_L thumb_end_r_055 "
        "PoleTarget.L r-LEGCONTROL Ctrl_Tail l-ARMORIENT control-heel-roll.l Ｃｔｒｌ knee_ctl "
        "neutral_bone handslot.r socket_hat Attach_Sword footRoll_L",
    ),
}


def listed(names):
    return names.split() if isinstance(names, str) else list(names)


@pytest.mark.parametrize("tool", SKELETONS)
def test_the_convention_of_a_tool(tool):
    bones, others = map(listed, SKELETONS[tool])
    names = bones + others
    random.Random(tool).shuffle(names)
    ruled_out = {
        name
        for name, (kind, _) in zip(names, kinds_by_name(names), strict=True)
        if kind in ("controls", "ends", "sockets", "roots", "others")
    }
    assert ruled_out == set(others)


def test_each_row_is_tested_and_says_where_it_comes_from():
    assert {row.tool for row in CONVENTIONS} == {tool.partition(",")[0] for tool in SKELETONS}
    assert all(row.source.startswith("https://") for row in CONVENTIONS)


@pytest.mark.parametrize(
    "names",
    [
        ["c_traj", "head.x", "arm"],
        ["ORG-arm", "DEF-arm", "arm"],
        ["UpperBody", "center", "tip"],
        ["finger_index_r_aux", "finger_0"],
        ["heel.02.L", "thigh.L"],
    ],
)
def test_few_names_do_not_make_a_convention(names):
    assert [kind for kind, _ in kinds_by_name(names)] == [""] * len(names)


def test_what_may_be_a_control_or_a_bone_is_unsure():
    names = ["IK-foot.l", "LeftFootIK", "Weapon.R", "handFK", "IKhand", "bike", "Wrist"]
    assert [kind for kind, _ in kinds_by_name(names)] == ["unsure"] * 5 + [""] * 2
    names = ["上半身", "下半身", "左足ＩＫ", "腰キャンセル", "左肩Ｐ"]
    assert [kind for kind, _ in kinds_by_name(names)] == [""] * 2 + ["unsure"] * 3
