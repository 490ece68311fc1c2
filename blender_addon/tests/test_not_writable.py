# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that cannot be written: linked from another file, or in edit mode through another object."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, new_object, said

ops = bpy.ops.intrinsic_symmetry


def _activate(object, *others):
    for each in (object, *others):
        each.select_set(True)
    bpy.context.view_layer.objects.active = object


@pytest.fixture
def body(human):
    """With a group and a key on the left side."""
    left = np.flatnonzero(attribute(human.data, "sym_side") == 1)
    human.vertex_groups.new(name="Arm.L").add(left.tolist(), 0.75, "REPLACE")
    human.shape_key_add(name="Basis")
    key = human.shape_key_add(name="Puff.L", from_mix=False)
    module("mesh_data").set_key_positions(key, module("mesh_data").key_positions(key) + np.float32((0, 0, 0.01)))
    human.active_shape_key_index = 1
    return human


@pytest.fixture
def linked(body, tmp_path):
    """A body with the same faces and without groups, in another file."""
    twin = new_object(body.data.copy(), "twin")
    twin.shape_key_clear()
    twin.vertex_groups.clear()
    bpy.data.libraries.write(str(tmp_path / "lib.blend"), {twin})
    bpy.data.objects.remove(twin)
    with bpy.data.libraries.load(str(tmp_path / "lib.blend"), link=True) as (_, wanted):
        wanted.objects = ["twin"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    bpy.context.view_layer.update()
    _activate(body, wanted.objects[0])
    yield wanted.objects[0]
    bpy.data.libraries.remove(wanted.objects[0].library)


@pytest.mark.parametrize("what", ["KEY", "WEIGHTS"])
def test_nothing_is_transferred_to_a_linked_mesh(body, linked, what):
    with pytest.raises(RuntimeError, match='"twin" is linked from another file: make it local first'):
        ops.transfer(what=what)
    assert not linked.vertex_groups and linked.data.shape_keys is None


def test_a_linked_mesh_that_is_passed_over_is_named(body, linked, capfd):
    assert "1 without (twin: the mesh is linked from another file" in said(capfd, ops.detect_selected, again=True)


def test_linked_meshes_are_no_part_of_a_character(body, linked):
    with pytest.raises(RuntimeError, match='"twin" is linked from another file: make it local first'):
        ops.detect(together=True)


def test_a_linked_mesh_and_its_override_are_refused(body, linked):
    body.select_set(False)
    override = linked.override_create()
    bpy.context.scene.collection.objects.link(override)
    for object in (linked, override):
        _activate(object)
        for tool in (ops.detect, ops.clear, ops.mirror_vertex_groups):
            with pytest.raises(RuntimeError, match="linked from another file: make it local first"):
                tool()


def test_pairs_of_a_linked_mesh_are_exported(body, linked, tmp_path):
    """That only reads."""
    body.select_set(False)
    _activate(linked)
    path = tmp_path / "pairs.csv"
    assert ops.export_pairs(filepath=str(path)) == {"FINISHED"}
    assert len(path.read_text().splitlines()) == 1 + len(linked.data.vertices)


@pytest.mark.parametrize("name", ["intrinsic_symmetry_live", "intrinsic_symmetry_live_select"])
def test_live_does_not_go_on_for_a_linked_mesh_and_says_why(body, linked, name):
    local = bpy.data.objects.new("local", linked.data)
    bpy.context.scene.collection.objects.link(local)
    bpy.context.view_layer.update()
    setattr(local, name, True)
    assert not getattr(local, name)
    assert "linked from another file: make it local first" in module("live").problem_of(local)


@pytest.fixture
def free_modes():
    """Blender's Lock Object Modes is off: another object than the active one may be in edit mode."""
    bpy.context.scene.tool_settings.lock_object_mode = False
    yield
    for object in bpy.context.view_layer.objects:
        if object.mode == "EDIT":
            bpy.context.view_layer.objects.active = object
            enter("OBJECT")
    bpy.context.scene.tool_settings.lock_object_mode = True


@pytest.fixture
def edited(body, free_modes):
    """A twin of the body in edit mode; the body is active, in object mode."""
    twin = new_object(body.data.copy(), "twin")
    twin.shape_key_clear()
    twin.vertex_groups.clear()
    enter("EDIT")
    _activate(body, twin)
    assert (body.mode, twin.mode) == ("OBJECT", "EDIT")
    return twin


@pytest.mark.parametrize("what", ["KEY", "WEIGHTS"])
def test_nothing_is_transferred_to_a_mesh_in_edit_mode(body, edited, what):
    with pytest.raises(RuntimeError, match='"twin" is in edit mode: leave it first'):
        ops.transfer(what=what)
    bpy.context.view_layer.objects.active = edited
    enter("OBJECT")
    assert not edited.vertex_groups and edited.data.shape_keys is None


def test_detect_names_those_in_edit_mode(body, edited, capfd):
    assert "1 without (twin: the mesh is in edit mode: leave it first" in said(capfd, ops.detect_selected, again=True)
    with pytest.raises(RuntimeError, match='"twin" is in edit mode: leave it first'):
        ops.detect(together=True)


@pytest.mark.parametrize("tool", ["detect", "mirror_vertex_groups", "symmetrize", "symmetrize_topology", "select",
                                  "import_pairs"])
def test_a_mesh_that_is_edited_through_another_object(body, free_modes, tool):
    other = bpy.data.objects.new("second", body.data)
    bpy.context.scene.collection.objects.link(other)
    bpy.context.view_layer.update()
    enter("EDIT")
    bpy.context.view_layer.objects.active = other
    with pytest.raises(RuntimeError, match="is in edit mode through another object: leave that first"):
        getattr(ops, tool)()
    bpy.context.view_layer.objects.active = body
    assert len(body.data.vertices) and body.mode == "EDIT"


def test_a_member_of_a_character_in_edit_mode(body, free_modes):
    twin = new_object(body.data.copy(), "twin")
    twin.location.x = 3
    bpy.context.view_layer.update()
    _activate(body, twin)
    assert ops.detect(together=True) == {"FINISHED"}
    body.select_set(False)
    _activate(twin)
    enter("EDIT")
    _activate(body)
    with pytest.raises(RuntimeError, match='"twin" is in edit mode: leave it first'):
        ops.mirror_vertex_groups()
