# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirror while shape keys and groups come and go, and with values that nothing can be made of."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import enter, module, select
from test_live import a_hand, paint, places, stroke, switch

ops = bpy.ops


def _keys(object):
    return {key.name: module("mesh_data").key_positions(key) for key in object.data.shape_keys.key_blocks}


@pytest.mark.parametrize("active", [0, 1])
def test_the_other_keys_stay_when_the_active_one_is_removed(human, active):
    """The next key has its number then, and is no change of it."""
    human.shape_key_add(name="Basis")
    for name, offset in (("One", (0, 0, 0.02)), ("Two", (0.03, 0, 0))):
        key, hand = human.shape_key_add(name=name, from_mix=False), a_hand(human, 1)
        moved = module("mesh_data").key_positions(key)
        moved[hand] += np.float32(offset)
        module("mesh_data").set_key_positions(key, moved)
    human.active_shape_key_index = active
    paint(human, "SCULPT")
    stroke()
    before = _keys(human)
    ops.object.shape_key_remove()
    stroke()
    enter("OBJECT")
    after = _keys(human)
    assert len(after) == 2 and all(np.array_equal(before[name], after[name]) for name in after)


@pytest.fixture
def painted(human):
    """In weight paint mode, with Live Mirror on and Arm.L active."""
    for name in ("Arm.L", "Arm.R"):
        human.vertex_groups.new(name=name)
    human.vertex_groups.active = human.vertex_groups["Arm.L"]
    paint(human, "WEIGHT_PAINT")
    stroke()
    return human


def _paint(object, name):
    hand = a_hand(object, 1)
    object.vertex_groups[name].add(hand.tolist(), 0.75, "REPLACE")
    stroke()
    return {(vertex.index, group.group) for vertex in object.data.vertices for group in vertex.groups if group.weight}


@pytest.mark.parametrize("lose", [
    lambda groups: groups.remove(groups["Arm.R"]), lambda groups: setattr(groups["Arm.R"], "name", "Other"),
], ids=["removed", "renamed"])
def test_without_the_other_group_only_the_own_side_is_painted_and_the_panel_says_why(painted, lose, capfd):
    lose(painted.vertex_groups)
    stroke()
    found = _paint(painted, "Arm.L")
    assert {vertex for vertex, _ in found} == set(a_hand(painted, 1).tolist())
    assert "Error" not in "".join(capfd.readouterr())
    assert 'no group "Arm.R"' in module("live").problem_of(painted)
    painted.vertex_groups.new(name="Arm.R")
    painted.vertex_groups.active = painted.vertex_groups["Arm.L"]
    assert module("live").problem_of(painted) is None and painted.intrinsic_symmetry_live
    painted.vertex_groups["Arm.L"].remove(range(len(painted.data.vertices)))
    stroke()
    assert len(_paint(painted, "Arm.L")) == 2 * len(a_hand(painted, 1)), "it goes on"


def test_where_the_other_group_is_locked_the_panel_says_so(painted):
    painted.vertex_groups["Arm.R"].lock_weight = True
    found = _paint(painted, "Arm.L")
    assert {vertex for vertex, _ in found} == set(a_hand(painted, 1).tolist())
    assert module("live").problem_of(painted) == 'Live does not follow: the group "Arm.R" is locked'
    painted.vertex_groups["Arm.R"].lock_weight = False
    assert module("live").problem_of(painted) is None
    painted.vertex_groups["Arm.L"].remove(range(len(painted.data.vertices)))
    stroke()
    assert len(_paint(painted, "Arm.L")) == 2 * len(a_hand(painted, 1)), "it goes on"


def test_a_place_that_is_no_number_switches_off_and_says_so(human, capfd):
    select(human, a_hand(human, 1))
    enter("EDIT")
    switch(human)
    mesh = bmesh.from_edit_mesh(human.data)
    mesh.verts.ensure_lookup_table()
    mesh.verts[0].co.x = float("nan")
    bmesh.update_edit_mesh(human.data)
    bpy.context.view_layer.update()
    assert np.isnan(places(human)).any(axis=1).sum() == 1, "it is not carried further"
    enter("OBJECT")
    enter("EDIT")
    assert "Traceback" not in "".join(capfd.readouterr())
    assert not human.intrinsic_symmetry_live
    assert module("live").problem_of(human).startswith("Live Mirror is off: ")


def test_what_nobody_thought_of_switches_off_and_says_so(human, monkeypatch):
    """An update that fails is not tried again at each step, in silence."""
    def fail(*_):
        raise KeyError("unknown")

    paint(human, "SCULPT")
    stroke()
    monkeypatch.setattr(module("live").Session, "update", fail)
    stroke()
    assert not human.intrinsic_symmetry_live
    assert "KeyError" in module("live").problem_of(human)
