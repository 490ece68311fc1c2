# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer of keys and weights to objects with the same faces."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, new_object, positions, read_example, said, touching_shells

ops = bpy.ops.intrinsic_symmetry
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)


@pytest.fixture
def pair(human):
    """The human with a key and a group on its left side, and a copy that is turned and twice as large."""
    other = new_object(read_example("human"), "other")
    module("mesh_data").set_shown_positions(other, 2 * positions(other.data) @ TURN.T)
    side = attribute(human.data, "sym_side")
    human.shape_key_add(name="Basis")
    key = human.shape_key_add(name="Puff.L")
    key.slider_max = 3
    moved = np.where(side[:, None] == 1, 0.01 * np.random.default_rng(0).normal(size=(len(side), 3)), 0)
    module("mesh_data").set_key_positions(key, positions(human.data) + moved)
    human.active_shape_key_index = 1
    human.vertex_groups.new(name="Arm.L").add(np.flatnonzero(side == 1).tolist(), 0.75, "ADD")
    human.select_set(True)
    bpy.context.view_layer.objects.active = human
    return human, other, moved


def _moved(object, name):
    key = object.data.shape_keys.key_blocks[name]
    return module("mesh_data").key_positions(key).astype(float) - positions(object.data)


def test_a_key_turns_and_grows_with_the_surface(pair, mode):
    _, other, moved = pair
    enter(mode)
    assert ops.transfer(what="KEY") == {"FINISHED"}
    enter("OBJECT")
    assert np.abs(_moved(other, "Puff.L") - 2 * moved @ TURN.T).max() < 1e-4
    assert other.data.shape_keys.key_blocks["Puff.L"].slider_max == 3


@pytest.mark.parametrize("across, there", [(False, False), (False, True), (True, False)])
def test_a_key_that_is_made_keeps_its_vertex_group_and_mute(pair, across, there):
    """A group that the other object lacks is given, too; one that is there stays."""
    human, other, _ = pair
    key, side = human.data.shape_keys.key_blocks["Puff.L"], attribute(human.data, "sym_side")
    key.vertex_group, key.mute = "Arm.L", True
    if there:
        other.vertex_groups.new(name="Arm.L").add(range(9), 0.5, "ADD")
    assert ops.transfer(what="KEY", across=across) == {"FINISHED"}
    end = "R" if across else "L"
    made = other.data.shape_keys.key_blocks[f"Puff.{end}"]
    assert made.vertex_group == f"Arm.{end}" and made.mute
    assert other.vertex_groups.keys() == [f"Arm.{end}"]
    wanted = 0.5 * (np.arange(len(side)) < 9) if there else np.where(side == (-1 if across else 1), 0.75, 0)
    assert np.allclose(module("weights").read_weights(other)[:, 0], wanted)


def test_a_key_across_the_symmetry(pair, truth):
    human, other, moved = pair
    ops.mirror_shape_keys()
    wanted = _moved(human, "Puff.R")
    human.active_shape_key_index = 1
    ops.transfer(what="KEY", across=True)
    wrong = np.linalg.norm(_moved(other, "Puff.R") - 2 * wanted @ TURN.T, axis=1)
    assert wrong.mean() < 0.02 * np.linalg.norm(2 * wanted, axis=1).mean(), "frames of two bodies are a little wider"
    assert "Puff.L" not in other.data.shape_keys.key_blocks


@pytest.mark.parametrize("across", [False, True])
def test_shells_that_touch_do_so_afterwards(truth, across):
    """On a body in another pose, where each shell has local frames of its own."""
    object, ((left, its), (right, other)) = touching_shells(truth, 0)
    before = positions(object.data)
    twin = new_object(object.data.copy(), "twin")
    bent = before + np.sin(9 * before[:, [2, 0, 1]]) * 0.04
    module("mesh_data").set_shown_positions(twin, bent)
    object.select_set(True)
    bpy.context.view_layer.objects.active = object
    assert ops.detect() == {"FINISHED"}
    object.shape_key_add(name="Basis")
    key = object.shape_key_add(name="Puff.L")
    object.active_shape_key_index = 1
    edit = np.maximum(1 - np.linalg.norm(before - before[left], axis=1) / 0.2, 0)[:, None] * (0.1, 0.05, 0)
    module("mesh_data").set_key_positions(key, before + edit)
    assert ops.transfer(what="KEY", across=across) == {"FINISHED"}
    moved = _moved(twin, "Puff.R" if across else "Puff.L")
    one, touching = (right, other) if across else (left, its)
    assert np.linalg.norm(moved[one]) > 0.05 and np.abs(moved[one] - moved[touching]).max() < 1e-6


@pytest.mark.parametrize("across", [False, True])
def test_weights(pair, across):
    human, other, _ = pair
    ops.transfer(what="WEIGHTS", across=across)
    side = attribute(human.data, "sym_side")
    column = module("weights").read_weights(other)[:, 0]
    assert other.vertex_groups[0].name == ("Arm.R" if across else "Arm.L")
    assert np.allclose(column, np.where(side == (-1 if across else 1), 0.75, 0))


def test_names_with_two_sides_across(pair):
    human, other, _ = pair
    human.vertex_groups[0].name = "Hair_R_end.L"
    human.vertex_groups.new(name="Hair_R_end.R")
    ops.transfer(what="WEIGHTS", across=True)
    assert sorted(other.vertex_groups.keys()) == ["Hair_R_end.L", "Hair_R_end.R"]
    assert module("weights").read_weights(other)[:, other.vertex_groups["Hair_R_end.R"].index].any()


def test_what_is_there_stays(pair):
    human, other, _ = pair
    group = other.vertex_groups.new(name="Arm.L")
    ops.transfer(what="WEIGHTS")
    read = module("weights").read_weights
    assert not read(other).any()
    ops.transfer(what="KEYS")
    before = _moved(other, "Puff.L")
    key = human.data.shape_keys.key_blocks["Puff.L"]
    module("mesh_data").set_key_positions(key, positions(human.data))
    ops.transfer(what="KEYS")
    assert np.array_equal(_moved(other, "Puff.L"), before)
    ops.transfer(what="KEYS", replace=True)
    assert np.abs(_moved(other, "Puff.L")).max() < 1e-6
    group.lock_weight = True
    ops.transfer(what="WEIGHTS", replace=True)
    assert not read(other).any()
    group.lock_weight = False
    ops.transfer(what="WEIGHTS", replace=True)
    assert read(other).any()


def test_locked_keys_stay_and_are_named(pair, capfd):
    _, other, _ = pair
    ops.transfer(what="KEYS")
    key = other.data.shape_keys.key_blocks["Puff.L"]
    module("mesh_data").set_key_positions(key, positions(other.data))
    key.lock_shape = True
    assert "locked: other: Puff.L" in said(capfd, ops.transfer, what="KEYS", replace=True)
    assert not _moved(other, "Puff.L").any()


def test_what_is_needed(pair):
    human, other, _ = pair
    other.select_set(False)
    with pytest.raises(RuntimeError, match="Select the objects"):
        ops.transfer()
    new_object(read_example("quadruped"), "animal")
    human.select_set(True)
    bpy.context.view_layer.objects.active = human
    with pytest.raises(RuntimeError, match="\"animal\" has other faces"):
        ops.transfer()
    bpy.data.objects["animal"].select_set(False)
    other.select_set(True)
    human.active_shape_key_index = 0
    with pytest.raises(RuntimeError, match="not the basis"):
        ops.transfer()


@pytest.mark.parametrize("data, why", [(True, '"it" shares the mesh of the active object'), (False, '"it" is not a mesh')])
def test_what_cannot_be_transferred_to_is_named(pair, data, why):
    human, other, _ = pair
    other.select_set(False)
    it = bpy.data.objects.new("it", human.data if data else None)
    bpy.context.scene.collection.objects.link(it)
    it.select_set(True)
    with pytest.raises(RuntimeError, match=why):
        ops.transfer()


def test_objects_that_share_a_mesh_are_one(pair, capfd):
    _, other, _ = pair
    twin = other.copy()
    bpy.context.scene.collection.objects.link(twin)
    twin.select_set(True)
    assert "1 shape keys transferred to 1 objects" in said(capfd, ops.transfer, what="KEY")


def test_names_that_are_too_long_on_the_other_side_are_refused(pair):
    human, other, _ = pair
    human.vertex_groups[0].name = 59 * "x" + "Left"
    with pytest.raises(RuntimeError, match='"x{59}Right" is too long for Blender: shorten the name'):
        ops.transfer(what="WEIGHTS", across=True)
    assert not other.vertex_groups
