# SPDX-License-Identifier: GPL-3.0-or-later
"""Left and right in names."""

import bpy
import pytest
from conftest import module, said

PAIRS = {
    "Blender": [("Arm.L", "Arm.R"), ("l_arm", "r_arm"), ("arm-Left.001", "arm-Right.001"), ("leftarm", "rightarm"),
                ("ARMLEFT", "ARMRIGHT"), ("arm.l.003", "arm.r.003"), ("L arm", "R arm")],
    "Mixamo": [("mixamorig:LeftArm", "mixamorig:RightArm"), ("mixamorig1:LeftHand", "mixamorig1:RightHand")],
    "VRM": [("J_Bip_L_UpperArm", "J_Bip_R_UpperArm"), ("Fcl_EYE_Close_L", "Fcl_EYE_Close_R")],
    "Unreal": [("upperarm_twist_01_l", "upperarm_twist_01_r"), ("ik_hand_l", "ik_hand_r")],
    "Source": [("ValveBiped.Bip01_L_UpperArm", "ValveBiped.Bip01_R_UpperArm")],
    "3ds Max": [("Bip01 L UpperArm", "Bip01 R UpperArm"), ("CATRigLArmPalm", "CATRigRArmPalm")],
    "Daz": [("lShldr", "rShldr"), ("lThighBend", "rThighBend"), ("l_upperarm", "r_upperarm")],
    "Rigify": [("DEF-upper_arm.L.001", "DEF-upper_arm.R.001"), ("DEF-ear.L_master", "DEF-ear.R_master"),
               ("DEF-lid.B.L", "DEF-lid.B.R")],
    "Auto-Rig Pro": [("arm_stretch.l", "arm_stretch.r"), ("c_index1_base.l", "c_index1_base.r")],
    "MMD": [("左腕", "右腕"), ("左足ＩＫ", "右足ＩＫ"), ("腕.L", "腕.R"), ("左ひじ.L", "右ひじ.R"),
            ("まばたき左", "まばたき右"), ("ひだり腕", "みぎ腕"), ("ウィンクヒダリ", "ウィンクミギ"), ("ﾋﾀﾞﾘ足", "ﾐｷﾞ足")],
    "others": [("eyeBlinkLeft", "eyeBlinkRight"), ("EyeBlinkL", "EyeBlinkR"), ("LArm", "RArm"), ("left", "right"),
               ("Arm_Lft", "Arm_Rgt"), ("lft_arm.001", "rgt_arm.001"), ("ARM LFT", "ARM RGT"), ("armLft01", "armRgt01"),
               ("Palm1L", "Palm1R"), ("f_indexFBXASC04601FBXASC046L", "f_indexFBXASC04601FBXASC046R")],
}
WITHOUT = ["Spine", "Eyes_L_R", "LeftRight", "左右", "ひだりみぎ", "chin_cleft", "Bright", "upright", "Control", "RGB", "LOD0",
           "IKLeg", "root.x", "roll", "RealLife", "lip", "Tail", "ball", "L1", "Fur", "Lftarm", "Rgta"]


@pytest.mark.parametrize("convention", PAIRS)
def test_both_ways(convention):
    side_names = module("side_names")
    for left, right in PAIRS[convention]:
        assert (side_names.flip(left), side_names.flip(right)) == (right, left)
        assert (side_names.side(left), side_names.side(right)) == (1, -1)


@pytest.mark.parametrize("pair", PAIRS["Blender"])
def test_blender_says_the_same(pair):
    assert bpy.utils.flip_name(pair[0]) == pair[1] == module("side_names").flip(pair[0])


def test_names_without_a_side():
    side_names = module("side_names")
    assert [name for name in WITHOUT if side_names.side(name) or side_names.flip(name) != name] == []


def test_words_that_only_hold_a_side():
    assert [module("side_names").side(name) for name in ("Copyright", "leftover", "Leftover_1")] == [0, 0, 0]


def test_a_capital_before_a_small_letter_is_a_side_where_both_names_are_there():
    side_names = module("side_names")
    names = ["Lhand", "Rhand", "Rig_Lfoot", "Rig_Rfoot", "Lip", "Roll", "Light", "Right", "Left", "Lfoot"]
    wanted = ["Rhand", "Lhand", "Rig_Rfoot", "Rig_Lfoot", "Lip", "Roll", "Light", "Left", "Right", "Lfoot"]
    assert [side_names.counterpart(name, names) for name in names] == wanted
    assert [side_names.side(name, names) for name in names] == [1, -1, 1, -1, 0, 0, 0, -1, 1, 0]


def test_a_capital_in_the_middle_is_a_side_where_both_names_are_there():
    side_names = module("side_names")
    names = ["HandLfinger", "HandRfinger", "Arm2Rlower", "Arm2Llower", "LipRupperLip", "LipLupperLip", "HandLthumb",
             "ToeRoll", "HeadLight", "HeadRight", "IKLeg", "IKReg"]
    wanted = ["HandRfinger", "HandLfinger", "Arm2Llower", "Arm2Rlower", "LipLupperLip", "LipRupperLip", "HandLthumb",
              "ToeRoll", "HeadLight", "HeadLeft", "IKLeg", "IKReg"]
    assert [side_names.counterpart(name, names) for name in names] == wanted
    assert [side_names.side(name, names) for name in names] == [1, -1, -1, 1, -1, 1, 0, 0, 0, -1, 0, 0]


def test_words_of_one_s_own():
    side_names = module("side_names")
    preferences = bpy.context.preferences.addons[module("preferences").__package__].preferences
    assert side_names.flip("brazo_izq") == "brazo_izq"
    preferences.left_word, preferences.right_word = "_izq", "_der"
    try:
        assert (side_names.flip("brazo_izq"), side_names.flip("mano_der.001")) == ("brazo_der", "mano_izq.001")
        assert side_names.side("brazo_izq") == 1 and side_names.flip("Arm.L") == "Arm.R"
    finally:
        preferences.left_word = preferences.right_word = ""


def test_numbers_of_exporters_do_not_part_a_pair():
    counterpart = module("side_names").counterpart
    names = ["Leg_L_019", "Leg_R_022", "Arm_L_01", "Arm_L_02", "Arm_R_01", "Spine_03"]
    found = [counterpart(name, names) for name in names]
    assert found == ["Leg_R_022", "Leg_L_019", "Arm_R_01", "Arm_R_02", "Arm_L_01", "Spine_03"]


def test_the_last_of_two_sides_decides():
    side_names = module("side_names")
    names = [f"Hair_{first}_end.{last}" for first in "LR" for last in "LR"]
    assert side_names.flip("Hair_R_end.L") == bpy.utils.flip_name("Hair_R_end.L") == "Hair_R_end.R"
    assert [side_names.side(name) for name in names] == [1, -1, 1, -1]
    assert [side_names.counterpart(name, names) for name in names] == [names[1], names[0], names[3], names[2]]
    pair = ["Hair_R_end.L", "Hair_R_end.R"]
    assert [side_names.counterpart(name, pair) for name in pair] == pair[::-1]


def test_names_that_are_written_otherwise():
    written_otherwise = module("side_names").written_otherwise
    alike = [("arm.R", "Arm.R"), ("arm.R", "arm.r"), ("Right Arm", "RightArm"), ("R.arm", "arm.R"), ("arm.R.001", "arm.R")]
    assert [written_otherwise([made], ["Spine", there]) for made, there in alike] == [[made] for made, _ in alike]
    assert written_otherwise(["arm.R.001"], ["arm.L.001", "arm.L", "arm.R"]) == [], "that is of another pair"
    assert written_otherwise(["Finger1.R"], ["Finger1.L", "Finger2.R", "Finger1", "Arm.R"]) == []


@pytest.mark.parametrize("what", ["vertex_groups", "shape_keys"])
def test_what_is_made_beside_a_name_that_is_written_otherwise_is_named(human, what, capfd):
    for name in ("Basis", "arm.L", "Arm.R"):
        if what == "vertex_groups":
            human.vertex_groups.new(name=name)
        else:
            human.shape_key_add(name=name)
    human.active_shape_key_index = 1
    text = said(capfd, getattr(bpy.ops.intrinsic_symmetry, f"mirror_{what}"))
    assert 'Made: "arm.R"' in text and 'though it is there in other letters: "arm.R"' in text
