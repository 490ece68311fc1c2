# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirror's buttons, and what it says when it switches itself off."""

import bpy

from . import live, stored_map


class INTRINSIC_SYMMETRY_OT_say(bpy.types.Operator):
    """Shows a warning in the status bar; only an operator with a window can"""

    bl_idname = "intrinsic_symmetry.say"
    bl_label = "Say"
    bl_options = {"INTERNAL"}

    text: bpy.props.StringProperty()

    def invoke(self, context, _event):
        self._timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self._timer)
        self.report({"WARNING"}, self.text)
        return {"FINISHED"}


def draw(layout, object):
    """Both toggles, in the panel."""
    row = layout.row(align=True)
    row.enabled = stored_map.why_none(object) is None
    row.prop(object, "intrinsic_symmetry_live", toggle=True, icon="MOD_MIRROR")
    row.prop(object, "intrinsic_symmetry_live_select", toggle=True, icon="RESTRICT_SELECT_OFF", text="")
    if live.problem_of(object):
        layout.label(text=live.problem_of(object), icon="ERROR")


def _draw_header(self, context):
    object = context.active_object
    if object is None or object.type != "MESH" or object.mode == "OBJECT" or stored_map.why_none(object):
        return
    row = self.layout.row(align=True)
    row.prop(object, "intrinsic_symmetry_live", toggle=True, icon="MOD_MIRROR", text="Live")
    if object.mode == "EDIT":
        row.prop(object, "intrinsic_symmetry_live_select", toggle=True, icon="RESTRICT_SELECT_OFF", text="")


def register():
    bpy.utils.register_class(INTRINSIC_SYMMETRY_OT_say)
    bpy.types.VIEW3D_HT_tool_header.append(_draw_header)


def unregister():
    bpy.types.VIEW3D_HT_tool_header.remove(_draw_header)
    bpy.utils.unregister_class(INTRINSIC_SYMMETRY_OT_say)
