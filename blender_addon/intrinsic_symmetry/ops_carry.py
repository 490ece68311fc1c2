# SPDX-License-Identifier: GPL-3.0-or-later
"""Carry the map through an edit now, and say in the panel that it is due."""

import bmesh
import bpy

from . import assembly, stored_map
from .operator_base import MapOperator


class INTRINSIC_SYMMETRY_OT_carry(MapOperator, bpy.types.Operator):
    """Carry the symmetry through an edit of vertices and faces: extrude, loop cut, subdivide, delete, dissolve, merge.
    Every tool does so by itself; the overlays and Live Mirror need it done"""

    bl_idname = "intrinsic_symmetry.carry"
    bl_label = "Update Symmetry"

    def run_with(self, symmetry, _context, _object, _mode):
        return f"{(symmetry.partner >= 0).mean():.1%} of the vertices have a mirror image"


def _has_changed(mesh):
    """Whether a mesh has another number of vertices or faces than its map."""
    if stored_map.RECORD not in mesh:
        return False
    edited, record = bmesh.from_edit_mesh(mesh) if mesh.is_editmode else None, mesh[stored_map.RECORD]
    vertices, faces = (edited.verts, edited.faces) if edited else (mesh.vertices, mesh.polygons)
    return (len(vertices), len(faces)) != (record["vertices"], record["faces"])


def draw(layout, object):
    """In the panel, where the mesh was edited since."""
    if stored_map.may_be_carried(object.data) and any(_has_changed(each.data) for each in assembly.there(object)):
        layout.label(text="Edited since; the next tool updates it", icon="INFO")
        column = layout.column(align=True)
        column.operator("intrinsic_symmetry.carry", icon="FILE_REFRESH")
        if "members" not in object.data[stored_map.RECORD]:
            column.operator("intrinsic_symmetry.symmetrize_topology", text="Mirror This Edit").direction = "EDITED"


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_carry,))
