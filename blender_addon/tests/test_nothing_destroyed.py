# SPDX-License-Identifier: GPL-3.0-or-later
"""No tool destroys work: names that are not understood, sides, the middle, masks."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, new_object, positions, read_example, said, select, selected

ops = bpy.ops.intrinsic_symmetry


def _add(object, name, weights):
    group = object.vertex_groups.new(name=name)
    for vertex in np.flatnonzero(weights).tolist():
        group.add((vertex,), float(weights[vertex]), "REPLACE")


def _weights(object, name):
    return module("weights").read_weights(object)[:, object.vertex_groups[name].index]


def _patch(object, side, reach=0.3, beyond=False):
    """(vertices,) 0..1 around the outermost vertex of a side; beyond the middle too, around a vertex near it."""
    points, sides = positions(object.data), attribute(object.data, "sym_side")
    outward = np.where(sides == side, side * points[:, 0], -np.inf)
    middle = np.argmin(np.where(outward > 0, outward - 10 * points[:, 2], np.inf)) if beyond else outward.argmax()
    distance = np.linalg.norm(points - points[middle], axis=1) / np.ptp(points[:, 2])
    weights = np.maximum(reach - distance, 0) / reach
    return np.where((sides == side) | beyond, weights, 0).astype(np.float32)


@pytest.fixture
def arms(human, truth):
    """Weights of a left arm and of a right one, each another's mirror image but for a factor."""
    left = _patch(human, 1)
    return left, 0.5 * left[truth]


@pytest.mark.parametrize(
    "names",
    [
        ("mixamorig:LeftArm", "mixamorig:RightArm"),
        ("Bip01 L UpperArm", "Bip01 R UpperArm"),
        ("J_Bip_L_UpperArm", "J_Bip_R_UpperArm"),
        ("左腕", "右腕"),
        ("b_LeftArm_09", "b_RightArm_012"),
        ("lShldr", "rShldr"),
        ("Lhand", "Rhand"),
        ("ひだり腕", "みぎ腕"),
    ],
)
def test_names_of_other_programs(human, truth, arms, names):
    for name, weights in zip(names, arms):
        _add(human, name, weights)
    assert ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    assert np.allclose(_weights(human, names[0]), arms[0], atol=1e-6)
    assert np.allclose(_weights(human, names[1]), arms[0][truth], atol=1e-6)


@pytest.mark.parametrize("direction", ["LEFT_TO_RIGHT", "RIGHT_TO_LEFT", "AVERAGE", "SWAP"])
def test_a_side_that_no_pattern_knows_is_left_alone_and_named(human, arms, direction, capfd):
    for name, weights in zip(("brazo_izq", "brazo_der"), arms):
        _add(human, name, weights)
    text = said(capfd, ops.mirror_vertex_groups, direction=direction)
    assert "brazo_izq" in text and "brazo_der" in text and "Warning" in text
    for name, weights in zip(("brazo_izq", "brazo_der"), arms):
        assert np.array_equal(_weights(human, name), weights)


def test_a_lone_group_without_a_side_is_filled_but_not_emptied(human, truth, arms, capfd):
    _add(human, "Mask", arms[0])
    assert "Mask" in said(capfd, ops.mirror_vertex_groups, direction="RIGHT_TO_LEFT")
    assert np.array_equal(_weights(human, "Mask"), arms[0])
    assert 'onto the other side: "Mask"' in said(capfd, ops.mirror_vertex_groups, direction="LEFT_TO_RIGHT")
    assert np.allclose(_weights(human, "Mask"), arms[0] + arms[0][truth], atol=1e-6)


def test_a_lone_key_without_a_side_is_named_when_it_is_filled(human, arms, capfd):
    human.shape_key_add(name="Basis")
    key = human.shape_key_add(name="ウィンク")
    module("mesh_data").set_key_positions(key, positions(human.data) + 0.01 * arms[0][:, None])
    human.active_shape_key_index = 1
    key.lock_shape = True
    assert "onto the other side" not in said(capfd, ops.mirror_shape_keys)
    key.lock_shape = False
    assert 'onto the other side: "ウィンク"' in said(capfd, ops.mirror_shape_keys)


def test_a_central_group_with_a_side_in_its_name_is_left_alone(human, capfd):
    spine = np.ones(len(human.data.vertices), np.float32)
    _add(human, "Lumbar_L", spine)
    assert "Lumbar_L" in said(capfd, ops.mirror_vertex_groups)
    assert np.array_equal(_weights(human, "Lumbar_L"), spine) and len(human.vertex_groups) == 1


@pytest.mark.parametrize("direction", ["LEFT_TO_RIGHT", "RIGHT_TO_LEFT", "AVERAGE"])
def test_the_only_one_of_a_pair_is_never_erased(human, truth, arms, direction):
    _add(human, "Arm.L", arms[0])
    human.vertex_groups.new(name="Arm.R")  # as an armature with empty groups makes it
    ops.mirror_vertex_groups(direction=direction)
    assert np.array_equal(_weights(human, "Arm.L"), arms[0])
    assert np.allclose(_weights(human, "Arm.R"), arms[0][truth], atol=1e-6)


def test_both_groups_on_the_losing_arm_are_left_alone(human, truth, arms, capfd):
    for name in ("Arm.L", "Arm.R"):
        _add(human, name, arms[1])
    assert "Arm.L" in said(capfd, ops.mirror_vertex_groups, direction="LEFT_TO_RIGHT")
    assert np.array_equal(_weights(human, "Arm.L"), arms[1])
    assert ops.mirror_vertex_groups(direction="RIGHT_TO_LEFT") == {"FINISHED"}
    assert np.allclose(_weights(human, "Arm.L"), arms[1] + arms[1][truth], atol=1e-6)


@pytest.mark.parametrize("locked", ["Arm.L", "Arm.R"])
def test_an_exchange_with_a_locked_group_changes_neither(human, truth, arms, locked, capfd):
    for name, weights in zip(("Arm.L", "Arm.R"), arms):
        _add(human, name, weights)
    human.vertex_groups[locked].lock_weight = True
    text = said(capfd, ops.mirror_vertex_groups, direction="SWAP")
    assert "Arm.L" in text and "Arm.R" in text and "locked" in text
    for name, weights in zip(("Arm.L", "Arm.R"), arms):
        assert np.array_equal(_weights(human, name), weights)
    text = said(capfd, ops.mirror_vertex_groups, direction="AVERAGE")
    assert f'alone: "{locked}" (locked)' in text
    kept, mean = (arms[0], 0.75 * arms[0][truth]) if locked == "Arm.L" else (arms[1], 0.75 * arms[0])
    assert np.array_equal(_weights(human, locked), kept)
    assert np.allclose(_weights(human, "Arm.R" if locked == "Arm.L" else "Arm.L"), mean, atol=1e-6)


def test_the_active_group_is_carried_to_its_twin(human, truth, arms):
    for name, weights in zip(("Arm.L", "Arm.R"), arms):
        _add(human, name, weights)
    human.vertex_groups.active = human.vertex_groups["Arm.R"]
    ops.mirror_vertex_groups(all_groups=False)
    assert np.array_equal(_weights(human, "Arm.R"), arms[1])
    assert np.allclose(_weights(human, "Arm.L"), arms[1][truth], atol=1e-6)


def test_what_the_only_group_has_on_the_line_and_beyond_the_middle_stays(human, truth):
    leg, line = _patch(human, 1, reach=0.1, beyond=True), attribute(human.data, "sym_side") == 0
    right = attribute(human.data, "sym_side") == -1
    assert (leg[line] > 0).sum() > 5 and (leg[right] > 0).sum() > 20
    _add(human, "Leg.L", leg)
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    found = _weights(human, "Leg.L"), _weights(human, "Leg.R")
    assert np.allclose(found[0], leg, atol=1e-6)
    assert np.allclose(found[1], leg[truth], atol=1e-6)


def test_where_both_groups_spill_over_each_side_s_vertices_decide(human, truth):
    leg, side = _patch(human, 1, reach=0.1, beyond=True), attribute(human.data, "sym_side")
    other = 0.5 * leg[truth]
    _add(human, "Leg.L", leg)
    _add(human, "Leg.R", other)
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    left, right = side == 1, side == -1
    assert np.array_equal(_weights(human, "Leg.R")[left], other[left])
    assert np.allclose(_weights(human, "Leg.L")[right], other[truth][right], atol=1e-6)
    assert np.allclose(_weights(human, "Leg.R")[right], leg[truth][right], atol=1e-6)
    mean = (leg + other)[side == 0] / 2
    assert np.allclose(_weights(human, "Leg.L")[side == 0], mean, atol=1e-6)


def test_normalize(human):
    leg = _patch(human, 1, reach=0.1, beyond=True)
    _add(human, "Leg.L", leg)
    _add(human, "Hips", np.maximum(1 - leg, 0))
    _add(human, "Locked", np.full(len(leg), 0.25, np.float32))
    human.vertex_groups["Locked"].lock_weight = True
    before = module("weights").read_weights(human)
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT", normalize=True)
    after = module("weights").read_weights(human)
    changed = np.abs(after[:, :2] - before[:, :2]).max(axis=1) > 1e-5
    assert changed.any() and np.allclose(after[changed].sum(axis=1), 1, atol=1e-5)
    assert np.array_equal(after[:, 2], before[:, 2])


@pytest.mark.parametrize("locked", [0.25, 1.5])
def test_normalize_says_where_locked_groups_leave_no_room(human, locked, capfd):
    _add(human, "Leg.L", _patch(human, 1, reach=0.1))
    _add(human, "Locked", np.full(len(human.data.vertices), locked, np.float32))
    human.vertex_groups["Locked"].lock_weight = True
    _add(human, "Twice", np.full(len(human.data.vertices), locked, np.float32))
    human.vertex_groups["Twice"].lock_weight = True
    text = said(capfd, ops.mirror_vertex_groups, direction="LEFT_TO_RIGHT", normalize=True)
    assert ("do not sum to 1" in text) is (locked > 1)


@pytest.fixture
def facing_away():
    """The human turned half round: its left arm is at -X, and only that is painted, or named otherwise."""
    object = new_object(read_example("human"))
    for vertex in object.data.vertices:
        vertex.co.x, vertex.co.y = -vertex.co.x, -vertex.co.y
    object.data.update()
    points = positions(object.data)
    return object, np.where(points[:, 0] < -0.1 * np.ptp(points[:, 0]), 1.0, 0.0).astype(np.float32)


def _left_at_minus_x(object):
    points, side = positions(object.data), attribute(object.data, "sym_side")
    return points[side == 1, 0].mean() < points[side == -1, 0].mean()


@pytest.mark.parametrize("what", ["vertex groups", "bones", "shape keys"])
@pytest.mark.parametrize("left, right", [("Arm.L", "Arm.R"), ("Larm", "Rarm")])
def test_left_is_where_names_say(facing_away, what, left, right):
    object, weights = facing_away
    if what == "vertex groups":
        _add(object, left, weights)
        object.vertex_groups.new(name=right)
    elif what == "shape keys":
        for name in ("Basis", left, right):
            object.shape_key_add(name=name)
        moved = positions(object.data) + 0.01 * weights[:, None]
        module("mesh_data").set_key_positions(object.data.shape_keys.key_blocks[left], moved)
    else:
        _armature(object, weights, left, right)
    ops.detect()
    assert _left_at_minus_x(object)
    assert object.data["intrinsic_symmetry"]["left_from"] == f"names of {what}"


def _armature(object, weights, left, right):
    armature = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for name, sign in ((left, 1), (right, -1)):
        bone = armature.data.edit_bones.new(name)
        bone.head = positions(object.data)[weights == 1].mean(axis=0) * (sign, 1, 1)
        bone.tail = bone.head + bone.head.normalized() * 0.01
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = object
    object.modifiers.new("rig", "ARMATURE").object = armature


def test_left_is_plus_x_without_names(facing_away):
    object, _ = facing_away
    ops.detect()
    assert not _left_at_minus_x(object) and object.data["intrinsic_symmetry"]["left_from"] == "+X"
    ops.exchange_sides()
    assert _left_at_minus_x(object) and object.data["intrinsic_symmetry"]["left_from"] == "Exchange Sides"


def test_names_that_come_after_the_detection_count(facing_away, capfd):
    object, weights = facing_away
    ops.detect()
    _add(object, "Arm.L", weights)
    _add(object, "Arm.R", 0.1 * weights[attribute(object.data, "sym_vertex")])
    assert "Left is now" in said(capfd, ops.mirror_vertex_groups, direction="LEFT_TO_RIGHT")
    assert _left_at_minus_x(object)
    left = attribute(object.data, "sym_side") == 1
    assert np.array_equal(_weights(object, "Arm.L")[left], weights[left])


@pytest.mark.parametrize("exchanged", [False, True])
def test_names_that_are_exchanged_after_the_detection_count(facing_away, exchanged):
    """But not where the user has chosen the sides."""
    object, weights = facing_away
    _add(object, "Arm.L", weights)
    ops.detect()
    _add(object, "Arm.R", 0.1 * weights[attribute(object.data, "sym_vertex")])
    if exchanged:
        ops.exchange_sides()
        ops.exchange_sides()
    for group, name in zip(object.vertex_groups, ("other", "Arm.L")):
        group.name = name
    object.vertex_groups["other"].name = "Arm.R"
    right, before = attribute(object.data, "sym_side") == -1, _weights(object, "Arm.L")
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    assert _left_at_minus_x(object) == exchanged
    assert np.array_equal(_weights(object, "Arm.L")[right], before[right]) != exchanged


def test_hidden_vertices_stay(human):
    side = attribute(human.data, "sym_side")
    hidden = np.flatnonzero(side == -1)[::2]
    _add(human, "Spine", np.where(side == 1, 1, 0))
    before = positions(human.data)
    module("mesh_data").set_shown_positions(human, before + 0.01 * (side == 1)[:, None])
    dented = positions(human.data)
    enter("EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    enter("OBJECT")
    module("mesh_data").write_attribute(human.data, ".hide_vert", "BOOLEAN", np.isin(np.arange(len(side)), hidden))
    enter("EDIT")
    ops.remember()
    enter("OBJECT")
    module("mesh_data").set_shown_positions(human, dented + 0.01 * (side == 1)[:, None])
    edited = positions(human.data)
    enter("EDIT")
    ops.mirror_edit()
    ops.symmetrize(direction="LEFT_TO_RIGHT")
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    ops.select_line()
    enter("OBJECT")
    after = positions(human.data)
    assert np.array_equal(after[hidden], edited[hidden])
    assert np.abs(after - edited)[side == -1].max() > 0.005
    weights = _weights(human, "Spine")
    assert (weights[hidden] == 0).all() and weights[side == -1].max() == 1


def test_hidden_vertices_are_not_selected(human, truth, capfd):
    left = np.flatnonzero(attribute(human.data, "sym_side") == 1)[:500]
    select(human, left)
    hidden = np.isin(np.arange(len(truth)), truth[left[:250]])
    module("mesh_data").write_attribute(human.data, ".hide_vert", "BOOLEAN", hidden)
    enter("EDIT")
    assert "250 vertices selected" in said(capfd, ops.select)
    assert set(selected(human)) == set(truth[left[250:]])


def test_why_nothing_happens_is_said(human, capfd):
    right = attribute(human.data, "sym_side") == -1
    _add(human, "Arm.L", _patch(human, 1))
    group = human.vertex_groups.new(name="Arm.R")
    group.lock_weight = True
    text = said(capfd, ops.mirror_vertex_groups, direction="LEFT_TO_RIGHT")
    assert "0 vertices changed" in text and 'alone: "Arm.R" (locked)' in text and "hidden" not in text
    group.lock_weight = False
    human.shape_key_add(name="Basis")
    key = human.shape_key_add(name="Swell.L")
    module("mesh_data").set_key_positions(key, positions(human.data) + 0.01 * _patch(human, 1)[:, None])
    human.active_shape_key_index = 1
    select(human, np.flatnonzero(attribute(human.data, "sym_side") == 1)[:9])
    module("mesh_data").write_attribute(human.data, ".hide_vert", "BOOLEAN", right)
    enter("EDIT")
    for tool in (ops.mirror_vertex_groups, ops.mirror_shape_keys, ops.select):
        text = said(capfd, tool)
        assert "Info: 0 " in text and f"{right.sum()} vertices are hidden" in text


@pytest.mark.parametrize("mask", ["faces", "vertices", "sculpt"])
def test_masks_are_respected(human, mask):
    mesh_data, mesh = module("mesh_data"), human.data
    side = attribute(mesh, "sym_side")
    _add(human, "Spine", np.where(side == 1, 1, 0))
    free = np.zeros(len(side), bool)
    free[np.flatnonzero(side == -1)[:200]] = True
    select(human, free)
    if mask == "sculpt":
        mesh_data.write_attribute(mesh, ".sculpt_mask", "FLOAT", 1.0 - free)
    mesh.use_paint_mask, mesh.use_paint_mask_vertex = mask == "faces", mask == "vertices"
    if mask == "faces":
        chosen = np.array([face.select for face in mesh.polygons])
        free[:] = False
        free[[v for face, on in zip(mesh.polygons, chosen) if on for v in face.vertices]] = True
    enter("SCULPT" if mask == "sculpt" else "WEIGHT_PAINT")
    assert ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    assert np.array_equal(_weights(human, "Spine") > 0, (side == 1) | free & (side == -1))


def test_a_sculpt_mask_lets_every_tool_do_its_share(human):
    """Half masked: positions, attributes and keys go half the way."""
    mesh_data, mesh, side = module("mesh_data"), human.data, attribute(human.data, "sym_side")
    mesh_data.write_attribute(mesh, ".sculpt_mask", "FLOAT", np.full(len(side), 0.5))
    before, results = positions(mesh), {}
    for mode in ("OBJECT", "SCULPT"):
        mesh_data.set_shown_positions(human, before)
        enter(mode)
        ops.symmetrize(direction="LEFT_TO_RIGHT")
        enter("OBJECT")
        results[mode] = positions(mesh) - before
    assert np.allclose(results["SCULPT"], results["OBJECT"] / 2, atol=1e-5)
    mesh_data.write_attribute(mesh, "mine", "FLOAT", (side == 1).astype(float))
    enter("SCULPT")
    ops.mirror_attribute(name="mine", direction="LEFT_TO_RIGHT")
    enter("OBJECT")
    assert np.allclose(attribute(mesh, "mine"), np.where(side == -1, 0.5, side == 1), atol=1e-5)
    human.shape_key_add(name="Basis")
    key = human.shape_key_add(name="Swell.L")
    mesh_data.set_key_positions(key, mesh_data.key_positions(key) + 0.01 * _patch(human, 1)[:, None])
    human.active_shape_key_index = 1
    for name in ("OBJECT", "SCULPT"):
        enter(name)
        ops.mirror_shape_keys()
        enter("OBJECT")
        made = human.data.shape_keys.key_blocks["Swell.R"]
        results[name] = mesh_data.key_positions(made) - positions(mesh)
        mesh_data.set_key_positions(made, positions(mesh))
    assert np.abs(results["OBJECT"]).max() > 0.005 and np.allclose(results["SCULPT"], results["OBJECT"] / 2, atol=1e-5)
