# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar tab Symmetry of the 3D viewport."""

import bpy

from . import detection, eigenfunctions, labels, ops_carry, ops_detect, ops_live, overlay, preferences, stored_map


class SymmetryPanel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Symmetry"


def _has_map(context):
    """Whether the tools that need a map are to be used; buttons find out by themselves, menus do not."""
    object = context.active_object
    return object is not None and object.type == "MESH" and stored_map.why_none(object) is None


class INTRINSIC_SYMMETRY_PT_detect(SymmetryPanel, bpy.types.Panel):
    bl_label = "Intrinsic Symmetry"

    def draw(self, context):
        layout = self.layout
        if ops_detect.running:
            job = ops_detect.running[0]
            layout.progress(factor=job.fraction, text=f"{job.stage.capitalize()}   (Esc to cancel)")
            return
        options = preferences.of(context)
        if options is not None:
            layout.row().prop(options, "effort", expand=True)
        row = layout.row(align=True)
        row.operator("intrinsic_symmetry.detect", icon="MOD_MIRROR").source = "BASE"
        row.operator_menu_enum("intrinsic_symmetry.detect", "source", text="", icon="DOWNARROW_HLT")
        if context.mode == "OBJECT" and sum(other.type == "MESH" for other in context.selected_objects) > 1:
            layout.operator("intrinsic_symmetry.detect", text="Detect as One Character", icon="GROUP").together = True
            layout.operator("intrinsic_symmetry.detect_selected", text="Detect Each Selected Object")
        object = context.active_object
        if object is not None and object.type == "MESH":
            self._status(layout, object)

    def _status(self, layout, object):
        problem = stored_map.why_none(object)
        if problem:
            layout.label(text=problem, icon="INFO")
            return
        record = object.data[stored_map.RECORD]
        column = layout.column(align=True)
        confidence = f"confidence {record['mean_confidence']:.2f}"
        if record.get("doubtful"):
            column.label(text=f"Doubtful: mean {confidence}", icon="ERROR")
        else:
            column.label(text=f"Mean {confidence}", icon="CHECKMARK")
        if record["exact_share"] > 0:
            column.label(text=f"{record['exact_share']:.0%} from mirrored connectivity", icon="BLANK1")
        column.label(text=f"Left from {record['left_from']}", icon="BLANK1")
        if "members" in record:
            column.label(text=f"One map over {len(record['members'])} objects", icon="BLANK1")
        ops_carry.draw(layout, object)
        row = layout.row(align=True)
        row.operator("intrinsic_symmetry.exchange_sides", icon="ARROW_LEFTRIGHT")
        row.operator("intrinsic_symmetry.clear", text="", icon="X")
        self._alternatives(layout, object.data)
        ops_live.draw(layout, object)

    def _alternatives(self, layout, mesh):
        remembered = detection.remembered(mesh)
        if remembered is None or len(remembered[1]) < 2:
            return
        row = layout.row(align=True)
        row.label(text="Use symmetry")
        for number in range(1, len(remembered[1]) + 1):
            row.operator("intrinsic_symmetry.choose", text=str(number)).index = number


class INTRINSIC_SYMMETRY_PT_select(SymmetryPanel, bpy.types.Panel):
    bl_label = "Select"
    bl_parent_id = "INTRINSIC_SYMMETRY_PT_detect"

    def draw(self, context):
        column = self.layout.column(align=True)
        column.operator("intrinsic_symmetry.select", icon="RESTRICT_SELECT_OFF")
        column.operator("intrinsic_symmetry.select", text="Extend to Both Sides").extend = True
        column.operator("intrinsic_symmetry.select_line")
        column.operator("intrinsic_symmetry.select_to_line")
        column.operator("intrinsic_symmetry.select_unmatched")
        row = column.row()
        row.enabled = _has_map(context)
        row.operator_menu_enum("intrinsic_symmetry.select_asymmetric", "what")


class INTRINSIC_SYMMETRY_PT_uv(bpy.types.Panel):
    bl_label = "Intrinsic Symmetry"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Symmetry"

    @classmethod
    def poll(cls, context):
        return context.space_data.mode == "UV"

    def draw(self, _context):
        column = self.layout.column(align=True)
        column.operator("intrinsic_symmetry.select_uv", icon="RESTRICT_SELECT_OFF")
        column.operator("intrinsic_symmetry.select_uv", text="Extend to Both Sides").extend = True
        self.layout.operator_menu_enum("intrinsic_symmetry.mirror_uvs", "placement", icon="MOD_MIRROR")


class INTRINSIC_SYMMETRY_PT_mirror(SymmetryPanel, bpy.types.Panel):
    bl_label = "Mirror"
    bl_parent_id = "INTRINSIC_SYMMETRY_PT_detect"

    def draw(self, context):
        column = self.layout.column(align=True)
        column.enabled = _has_map(context)
        for name, icon in (
            ("mirror_vertex_groups", "GROUP_VERTEX"),
            ("mirror_shape_keys", "SHAPEKEY_DATA"),
            ("mirror_attribute", "SPREADSHEET"),
        ):
            column.operator_menu_enum(f"intrinsic_symmetry.{name}", "direction", icon=icon)


class INTRINSIC_SYMMETRY_PT_shape(SymmetryPanel, bpy.types.Panel):
    bl_label = "Shape"
    bl_parent_id = "INTRINSIC_SYMMETRY_PT_detect"

    def draw(self, context):
        column = self.layout.column(align=True)
        row = column.row()
        row.enabled = _has_map(context)
        row.operator_menu_enum("intrinsic_symmetry.symmetrize", "direction", icon="MOD_MIRROR")
        column.operator("intrinsic_symmetry.symmetrize_exactly", icon="MOD_MIRROR")
        row = column.row()
        row.enabled = _has_map(context)
        row.operator_menu_enum("intrinsic_symmetry.symmetrize_topology", "direction", icon="MOD_MIRROR")
        column.operator("intrinsic_symmetry.remember", icon="PINNED")
        column.operator("intrinsic_symmetry.mirror_edit", icon="UV_SYNC_SELECT")


class INTRINSIC_SYMMETRY_PT_show(SymmetryPanel, bpy.types.Panel):
    bl_label = "Show"
    bl_parent_id = "INTRINSIC_SYMMETRY_PT_detect"

    def draw(self, context):
        show = overlay.settings(context)
        column = self.layout.column()
        column.prop(show, "line")
        column.prop(show, "pairs")
        column.row().prop(show, "colours", text="")


class INTRINSIC_SYMMETRY_PT_label(SymmetryPanel, bpy.types.Panel):
    bl_label = "Correct and Label"
    bl_parent_id = "INTRINSIC_SYMMETRY_PT_detect"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, object = self.layout, context.active_object
        layout.operator("intrinsic_symmetry.study", icon="COLOR")
        if object is None or object.type != "MESH" or eigenfunctions.studied(object.data) is None:
            return
        entry = labels.active(object.data)
        if entry is None:
            return
        row = layout.row(align=True)
        row.operator("intrinsic_symmetry.step", text="", icon="TRIA_LEFT").by = -1
        row.label(text=f"{object.data.intrinsic_symmetry_eigenfunction} of {len(labels.of(object.data))}")
        row.operator("intrinsic_symmetry.step", text="", icon="TRIA_RIGHT").by = 1
        layout.label(text=f"Network: {labels.network_says(entry) or 'no answer'}")
        self._judgements(layout, entry)
        layout.operator("intrinsic_symmetry.detect", text="Detect with Corrections", icon="MOD_MIRROR")
        row = layout.row(align=True)
        row.operator("intrinsic_symmetry.save_labels", icon="EXPORT")
        row.operator("intrinsic_symmetry.forget_judgements", text="", icon="X")

    def _judgements(self, layout, entry):
        row = layout.row(align=True)
        for identifier, name, _ in labels.JUDGEMENTS:
            pressed = entry.judgement == identifier
            row.operator("intrinsic_symmetry.judge", text=name, depress=pressed).judgement = identifier


class INTRINSIC_SYMMETRY_PT_nodes(SymmetryPanel, bpy.types.Panel):
    bl_label = "Geometry Nodes"
    bl_parent_id = "INTRINSIC_SYMMETRY_PT_detect"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context):
        self.layout.operator_menu_enum("intrinsic_symmetry.add_node_group", "data_type", icon="GEOMETRY_NODES")


register, unregister = bpy.utils.register_classes_factory(
    (
        INTRINSIC_SYMMETRY_PT_detect,
        INTRINSIC_SYMMETRY_PT_select,
        INTRINSIC_SYMMETRY_PT_uv,
        INTRINSIC_SYMMETRY_PT_mirror,
        INTRINSIC_SYMMETRY_PT_shape,
        INTRINSIC_SYMMETRY_PT_show,
        INTRINSIC_SYMMETRY_PT_label,
        INTRINSIC_SYMMETRY_PT_nodes,
    )
)
