# SPDX-License-Identifier: GPL-3.0-or-later
"""The tools in Blender's own menus, where F3 finds them, and a pie menu. Their options are in the redo panel."""

import bpy

_POSE = "(Any Pose)"
_SELECT = (
    ("select", f"Select Mirror Image {_POSE}", {}),
    ("select", f"Extend to Mirror Image {_POSE}", {"extend": True}),
    ("select_line", "Select Symmetry Line", {}),
    ("select_to_line", "Grow to Symmetry Line", {}),
    ("select_unmatched", "Select Without Mirror Image", {}),
    ("select_asymmetric", "Select Asymmetric", {}),
)
_SHAPE = (
    ("symmetrize_exactly", "Symmetrize Exactly", {}),
    ("symmetrize", f"Symmetrize Positions {_POSE}", {}),
    ("symmetrize_topology", f"Symmetrize Topology {_POSE}", {}),
    ("remember", "Remember Shape for Mirror Edit", {}),
    ("mirror_edit", f"Mirror Edit {_POSE}", {}),
)
_GROUPS = (
    ("mirror_vertex_groups", f"Mirror All Weights {_POSE}", {"all_groups": True}),
    ("mirror_vertex_groups", f"Mirror Weights of Active Group {_POSE}", {"all_groups": False}),
)
_KEYS = (
    ("mirror_shape_keys", f"Mirror Active Shape Key {_POSE}", {"all_keys": False}),
    ("mirror_shape_keys", f"Mirror All Shape Keys {_POSE}", {"all_keys": True}),
    ("split_shape_key", "Split Shape Key into Left and Right", {}),
    ("join_shape_keys", "Join Left and Right Shape Keys", {}),
)
_MAP = (
    ("detect", "Detect Symmetry", {}),
    ("detect_selected", "Detect Symmetry of Selected Objects", {}),
    ("carry", "Update Symmetry after an Edit", {}),
    ("exchange_sides", "Exchange Left and Right", {}),
    ("clear", "Remove Symmetry", {}),
)
_TRANSFER = ("transfer", "Transfer Keys or Weights to Selected Objects", {})
_EXPORT = ("export_pairs", "Symmetry Pairs (.csv/.json)", {})
_IMPORT = ("import_pairs", "Symmetry Pairs (.csv/.json/.map)", {})
#: A menu of Blender's to what is added at its end: operator, text, properties.
ADDED = {
    "VIEW3D_MT_select_edit_mesh": _SELECT,
    "VIEW3D_MT_select_paint_mask_vertex": _SELECT[:2],
    "VIEW3D_MT_edit_mesh": _SHAPE,
    "VIEW3D_MT_sculpt": _SHAPE,
    "VIEW3D_MT_mask": (("mirror_attribute", f"Mirror Mask {_POSE}", {"name": ".sculpt_mask"}),),
    "VIEW3D_MT_paint_weight": _GROUPS,
    "VIEW3D_MT_edit_mesh_weights": _GROUPS,
    "MESH_MT_vertex_group_context_menu": _GROUPS,
    "MESH_MT_shape_key_context_menu": _KEYS,
    "MESH_MT_attribute_context_menu": (("mirror_attribute", f"Mirror Attribute {_POSE}", {}),),
    "VIEW3D_MT_make_links": (_TRANSFER,),
    "IMAGE_MT_uvs": (("mirror_uvs", "Mirror UV Islands to the Other Side", {}),),
    "TOPBAR_MT_file_export": (_EXPORT,),
    "TOPBAR_MT_file_import": (_IMPORT,),
    "IMAGE_MT_select": (
        ("select_uv", f"Select Mirror Image {_POSE}", {}),
        ("select_uv", f"Extend to Mirror Image {_POSE}", {"extend": True}),
    ),
}


def _draw(layout, entries):
    for name, text, values in entries:
        button = layout.operator(f"intrinsic_symmetry.{name}", text=text)
        for key, value in values.items():
            setattr(button, key, value)


def _adds(entries):
    """The function that Blender calls at the end of a menu."""

    def draw(menu, _context):
        menu.layout.separator()
        _draw(menu.layout, entries)

    return draw


def _colours(menu, context):
    """The active color attribute need not be the active attribute."""
    menu.layout.separator()
    name = context.object.data.color_attributes.active_color_name
    _draw(menu.layout, (("mirror_attribute", f"Mirror Colors {_POSE}", {"name": name}),))


class INTRINSIC_SYMMETRY_MT_tools(bpy.types.Menu):
    """Everything that needs no edit or paint mode"""

    bl_label = "Intrinsic Symmetry"

    def draw(self, _context):
        for entries in (_MAP, _SHAPE, _GROUPS, _KEYS):
            _draw(self.layout, entries)
            self.layout.separator()
        self.layout.operator("wm.call_menu_pie", text="Pie Menu").name = INTRINSIC_SYMMETRY_MT_pie.__name__


class INTRINSIC_SYMMETRY_MT_pie(bpy.types.Menu):
    """The tools around the mouse; give it a key of your own"""

    bl_label = "Intrinsic Symmetry"

    def draw(self, _context):
        # West, east, south, north, and the corners between.
        entries = (_SELECT[0], _SHAPE[4], _MAP[0], _SHAPE[0], _SELECT[2], _SHAPE[3], _GROUPS[0], _KEYS[0])
        _draw(self.layout.menu_pie(), entries)


def _submenu(menu, _context):
    menu.layout.separator()
    menu.layout.menu(INTRINSIC_SYMMETRY_MT_tools.__name__)


#: Menu to the function that was appended to it.
_APPENDED = {name: _adds(entries) for name, entries in ADDED.items()}
_APPENDED["VIEW3D_MT_object"] = _submenu
_APPENDED.update(dict.fromkeys(("VIEW3D_MT_paint_vertex", "MESH_MT_color_attribute_context_menu"), _colours))

_register, _unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_MT_tools, INTRINSIC_SYMMETRY_MT_pie))


def register():
    _register()
    for name, draw in _APPENDED.items():
        getattr(bpy.types, name).append(draw)


def unregister():
    for name, draw in _APPENDED.items():
        getattr(bpy.types, name).remove(draw)
    _unregister()
