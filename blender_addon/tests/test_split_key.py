# SPDX-License-Identifier: GPL-3.0-or-later
"""Split a shape key along a soft line, and join two."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions

ops = bpy.ops.intrinsic_symmetry


def _key(object, name, displacement):
    if object.data.shape_keys is None:
        object.shape_key_add(name="Basis")
    key = object.shape_key_add(name=name)
    module("mesh_data").set_key_positions(key, positions(object.data) + displacement)
    object.active_shape_key_index = object.data.shape_keys.key_blocks.find(name)
    return key


def _moved(object, name):
    key = object.data.shape_keys.key_blocks[name]
    return module("mesh_data").key_positions(key).astype(float) - positions(object.data)


@pytest.fixture
def smile(human):
    """(vertices, 3) a displacement of the whole body, the key "Smile"; it has a slider that goes below zero."""
    moved = 0.01 * np.random.default_rng(0).normal(size=(len(human.data.vertices), 3))
    _key(human, "Smile", moved).slider_min = -1
    return moved


def test_absolute_keys_are_not_split_or_joined(human, smile):
    human.data.shape_keys.use_relative = False
    for tool in (ops.split_shape_key, ops.join_shape_keys):
        assert not tool.poll()
        with pytest.raises(RuntimeError, match="absolute"):
            tool()


def test_left_and_right_are_the_old_key_together(human, smile, truth, mode):
    enter(mode)
    assert ops.split_shape_key(width=0.1) == {"FINISHED"}
    enter("OBJECT")
    left, right = _moved(human, "Smile.L"), _moved(human, "Smile.R")
    assert human.data.shape_keys.key_blocks.keys()[-2:] == ["Smile.L", "Smile.R"]
    assert np.abs(left + right - smile).max() < 1e-6
    assert np.abs(_moved(human, "Smile") - smile).max() < 1e-6, "the old key stays"
    assert human.data.shape_keys.key_blocks["Smile.R"].slider_min == -1
    share = np.linalg.norm(left, axis=1) / np.linalg.norm(smile, axis=1)
    side = attribute(human.data, "sym_side")
    assert np.abs(share[side == 0] - 0.5).max() < 1e-3
    assert np.abs(share + share[truth] - 1).max() < 0.02, "a vertex and its mirror image share it"
    assert share[side == 1].min() > 0.499 and share[side == -1].max() < 0.501
    soft = (share > 0.01) & (share < 0.99)
    assert 0.1 < soft.mean() < 0.9 and (side[soft] != 0).any()


def test_the_softness_is_as_wide_as_asked_for(human, smile):
    """The line of the human runs through the middle of its back, which is nearly flat: distance along x is distance."""
    ops.split_shape_key(width=0.05)
    left = np.linalg.norm(_moved(human, "Smile.L"), axis=1) / np.linalg.norm(smile, axis=1)
    points, side = positions(human.data), attribute(human.data, "sym_side")
    size = np.ptp(points, axis=0).max()
    line = points[side == 0]
    nearest = np.array([np.linalg.norm(line - point, axis=1).min() for point in points])
    assert (left[(nearest > 0.03 * size) & (side == 1)] > 0.999).all()
    between = (nearest > 0.01 * size) & (nearest < 0.015 * size) & (side == 1)
    assert 0.6 < np.median(left[between]) < 0.97


def test_a_hard_line(human, smile):
    ops.split_shape_key(width=0.0)
    side = attribute(human.data, "sym_side")
    left = _moved(human, "Smile.L")
    assert np.abs(left - smile)[side == 1].max() < 1e-6 and np.abs(left)[side == -1].max() < 1e-6


@pytest.mark.parametrize("left, right, whole", [
    ("Smile.L", "Smile.R", "Smile"), ("L_Smile", "R_Smile", "Smile"), ("brow.L.up", "brow.R.up", "brow.up"),
    ("smile_left", "smile_right", "smile"), ("smile_lft", "smile_rgt", "smile"), ("Lsmile", "Rsmile", "smile"),
    ("えがおひだり", "えがおみぎ", "えがお"),
])
def test_joining(human, smile, left, right, whole, mode):
    human.shape_key_remove(human.active_shape_key)
    _key(human, right, 0.5 * smile)
    _key(human, left, 2 * smile)
    enter(mode)
    assert ops.join_shape_keys() == {"FINISHED"}
    enter("OBJECT")
    assert human.active_shape_key.name == whole
    assert np.abs(_moved(human, whole) - 2.5 * smile).max() < 1e-6


def test_nothing_is_overwritten(human, smile):
    ops.split_shape_key()
    keys = human.data.shape_keys.key_blocks
    human.active_shape_key_index = keys.find("Smile")
    for tool, name in ((ops.split_shape_key, "Smile"), (ops.join_shape_keys, "Smile.L")):
        human.active_shape_key_index = keys.find(name)
        with pytest.raises(RuntimeError, match="is there already"):
            tool()
    human.active_shape_key_index = keys.find("Smile.L")
    with pytest.raises(RuntimeError, match="has a side in its name"):
        ops.split_shape_key()
    human.active_shape_key_index = keys.find("Smile")
    with pytest.raises(RuntimeError, match="no key of the other side"):
        ops.join_shape_keys()
    human.active_shape_key_index = 0
    with pytest.raises(RuntimeError, match="not the basis"):
        ops.split_shape_key()


@pytest.mark.parametrize("tool, name", [("split_shape_key", "Smile"), ("mirror_shape_keys", "Smile.L"),
                                        ("join_shape_keys", "Smile.L")])
def test_undo_in_edit_mode_takes_back_the_keys(human, smile, tool, name):
    """The active key is as it was; redo brings the keys back when edit mode is left."""
    if tool == "join_shape_keys":
        _key(human, "Smile.R", 0.5 * smile)
    human.data.shape_keys.key_blocks["Smile"].name = name
    human.active_shape_key_index = before = human.data.shape_keys.key_blocks.find(name)
    bpy.ops.ed.undo_push(message="start")
    enter("EDIT")
    bpy.ops.ed.undo_push(message="entered")
    names = human.data.shape_keys.key_blocks.keys()
    getattr(ops, tool)()
    human.data.shape_keys.key_blocks[-1].driver_add("value")
    made = human.data.shape_keys.key_blocks.keys()
    bpy.ops.ed.undo_push(message="made")
    assert len(made) > len(names)
    bpy.ops.ed.undo()
    human = bpy.context.object
    assert human.mode == "EDIT" and human.data.shape_keys.key_blocks.keys() == names
    assert human.active_shape_key_index == before and not human.data.shape_keys.animation_data.drivers
    bpy.ops.ed.redo()
    enter("OBJECT")
    assert human.data.shape_keys.key_blocks.keys() == made


def test_undo_in_edit_mode_leaves_keys_that_others_made(human, smile):
    bpy.ops.ed.undo_push(message="start")
    enter("EDIT")
    bpy.ops.ed.undo_push(message="entered")
    enter("OBJECT")
    human.shape_key_add(name="Other", from_mix=False)
    enter("EDIT")
    ops.split_shape_key()
    bpy.ops.ed.undo_push(message="made")
    bpy.ops.ed.undo()
    assert bpy.context.object.data.shape_keys.key_blocks.keys() == ["Basis", "Smile", "Other"]


def _shape(object, **values):
    """(vertices, 3) as the mesh is shown with the keys of these values."""
    for key in object.data.shape_keys.key_blocks:
        key.value = values.get(key.name.replace(".", "_"), 0)
    bpy.context.view_layer.update()
    return positions(object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data)


@pytest.mark.parametrize("masks", [("Left", "Right"), ("Left", "Left"), ("Left", "")])
def test_joined_keys_move_what_both_moved_with_their_masks(human, smile, masks):
    side = attribute(human.data, "sym_side")
    for name, on in (("Left", 1), ("Right", -1)):
        human.vertex_groups.new(name=name).add(np.flatnonzero(side == on).tolist(), 0.75, "REPLACE")
    human.shape_key_remove(human.active_shape_key)
    for name, mask in zip(("Smile.R", "Smile.L"), masks[::-1]):
        _key(human, name, smile).vertex_group = mask
    both = _shape(human, Smile_L=1, Smile_R=1)
    ops.join_shape_keys()
    assert np.abs(_shape(human, Smile=1) - both).max() < 1e-6


def test_a_name_without_room_for_a_side_is_not_split(human, smile):
    human.active_shape_key.name = "S" * 62
    with pytest.raises(RuntimeError, match='"S{62}.L" is too long for Blender: shorten the name'):
        ops.split_shape_key()
    assert len(human.data.shape_keys.key_blocks) == 2
