# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirror's buttons, in the panel and in the header."""

import bpy

from . import live, mesh_data, stored_map


def draw(layout, object):
    """Both toggles, in the panel."""
    row = layout.row(align=True)
    row.enabled = stored_map.why_none(object) is None
    row.prop(object, "intrinsic_symmetry_live", toggle=True, icon="MOD_MIRROR")
    row.prop(object, "intrinsic_symmetry_live_select", toggle=True, icon="RESTRICT_SELECT_OFF", text="")
    if live.problem_of(object):
        layout.label(text=live.problem_of(object), icon="ERROR")
    elif object.mode == "SCULPT" and mesh_data.has_multires(object):
        layout.label(text="Live does not follow Multires", icon="INFO")


def _draw_header(self, context):
    object = context.active_object
    if object is None or object.type != "MESH" or object.mode == "OBJECT" or stored_map.why_none(object):
        return
    row = self.layout.row(align=True)
    row.prop(object, "intrinsic_symmetry_live", toggle=True, icon="MOD_MIRROR", text="Live")
    if object.mode == "EDIT":
        row.prop(object, "intrinsic_symmetry_live_select", toggle=True, icon="RESTRICT_SELECT_OFF", text="")


def register():
    bpy.types.VIEW3D_HT_tool_header.append(_draw_header)


def unregister():
    bpy.types.VIEW3D_HT_tool_header.remove(_draw_header)
