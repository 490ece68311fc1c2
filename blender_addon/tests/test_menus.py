# SPDX-License-Identifier: GPL-3.0-or-later
"""The tools in Blender's own menus, and the options of a detection in the redo panel."""

import bpy
from conftest import MODULE, module, new_object, read_example


def _drawn_in(name):
    return getattr(bpy.types, name)._dyn_ui_initialize()


def test_every_entry_is_an_operator_with_its_properties():
    for entries in module("menus").ADDED.values():
        for name, _, values in entries:
            about = getattr(bpy.ops.intrinsic_symmetry, name).get_rna_type().properties
            assert set(values) <= set(about.keys()), name


def test_every_operator_is_in_a_menu_or_shows_its_own_panel():
    menus = module("menus")
    listed = {name for entries in (*menus.ADDED.values(), menus._MAP) for name, _, _ in entries}
    begin = "INTRINSIC_SYMMETRY_OT_"
    found = {name[len(begin) :] for name in dir(bpy.types) if name.startswith(begin)}
    of_panel = {"choose", "study", "step", "judge", "forget_judgements", "save_labels", "add_node_group"}
    assert found - of_panel <= listed


def test_menus_go_away_with_the_add_on():
    names = module("menus")._APPENDED.keys()
    ours = {name: module("menus")._APPENDED[name] for name in names}
    assert all(ours[name] in _drawn_in(name) for name in names)
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert not any(ours[name] in _drawn_in(name) for name in names)
    bpy.ops.preferences.addon_enable(module=MODULE)


def test_a_detection_begins_with_the_preferences_and_takes_its_own_options():
    new_object(read_example("quadruped"))
    preferences = bpy.context.preferences.addons[MODULE].preferences
    preferences.plausibility = 100
    try:
        assert bpy.ops.intrinsic_symmetry.detect() == {"FINISHED"}
        assert bpy.context.object.data["intrinsic_symmetry"]["doubtful"]
        assert bpy.ops.intrinsic_symmetry.detect(plausibility=50, effort="fast") == {"FINISHED"}
        assert not bpy.context.object.data["intrinsic_symmetry"]["doubtful"]
    finally:
        preferences.property_unset("plausibility")


def test_effort_is_called_fast_balanced_and_thorough():
    about = bpy.ops.intrinsic_symmetry.detect.get_rna_type().properties["effort"]
    assert [item.name for item in about.enum_items] == ["Fast", "Balanced", "Thorough"]
