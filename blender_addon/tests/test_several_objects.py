# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are in edit mode together, and what is said of what a tool does not touch."""

import bpy
import numpy as np
from conftest import attribute, enter, module, new_object, read_example, said, select

ops = bpy.ops.intrinsic_symmetry


def _copy_of(object, name):
    """Another object with a mesh and a map of its own, in the selection too."""
    other = bpy.data.objects.new(name, object.data.copy())
    bpy.context.scene.collection.objects.link(other)
    other.select_set(True)
    return other


def test_objects_in_edit_mode_are_all_worked_on(human, truth):
    other = _copy_of(human, "other")
    left = np.flatnonzero(attribute(human.data, "sym_side") == 1)
    chosen = {human: left[:20], other: left[40:70]}
    for object, vertices in chosen.items():
        select(object, vertices)
    enter("EDIT")
    assert ops.select() == {"FINISHED"}
    assert human.mode == other.mode == "EDIT"
    enter("OBJECT")
    for object, vertices in chosen.items():
        assert set(np.flatnonzero(module("mesh_data").selected_vertices(object.data))) == set(truth[vertices])


def test_a_selection_in_one_object_spares_the_others(human):
    other = _copy_of(human, "other")
    for object in (human, other):
        object.vertex_groups.new(name="Arm.L").add(np.flatnonzero(attribute(object.data, "sym_side") == 1).tolist(), 1, "ADD")
        select(object, [])
    left = np.flatnonzero(attribute(human.data, "sym_side") == 1)[:30]
    select(human, left)
    enter("EDIT")
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    enter("OBJECT")
    counts = [np.count_nonzero(module("weights").read_weights(object)[:, 1]) for object in (human, other)]
    assert counts == [30, 0]


def test_an_object_without_a_map_is_named_and_the_others_are_done(human, capfd):
    bare = new_object(read_example("quadruped"), "bare")
    human.select_set(True)
    bpy.context.view_layer.objects.active = human
    select(human, [0])
    select(bare, [0])
    enter("EDIT")
    text = said(capfd, ops.select)
    assert "bare: Detect the symmetry first" in text and f"{human.name}: 1 vertices selected" in text
    assert human.mode == bare.mode == "EDIT"


def test_what_is_not_touched_is_said(quadruped, capfd):
    text = said(capfd, ops.symmetrize, minimum_confidence=0.9)
    share = (attribute(quadruped.data, "sym_confidence") < 0.9).mean()
    assert 0.01 < share < 1
    assert f"{share:.1%} of the vertices have no mirror image, or none certain enough, and are not touched" in text
    assert "not touched" not in said(capfd, ops.symmetrize)
