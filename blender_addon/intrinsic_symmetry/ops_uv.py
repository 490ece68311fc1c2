# SPDX-License-Identifier: GPL-3.0-or-later
"""Select the mirror image of the UV selection."""

import bpy
import numpy as np

from . import mesh_data
from .elements import corner_partners, face_partners
from .operator_base import MapOperator


def names(mesh):
    """Names of the attributes that hold the UV selection: of corners, of the edges that begin there, of faces (or
    nothing). Blender 5.0 has one selection; before, each UV map has its own."""
    if bpy.app.version >= (5, 0, 0):
        return ".uv_select_vert", ".uv_select_edge", ".uv_select_face"
    return f".vs.{mesh.uv_layers.active.name}", f".es.{mesh.uv_layers.active.name}", None


class INTRINSIC_SYMMETRY_OT_select_uv(MapOperator, bpy.types.Operator):
    """Select the mirror image of the selected UVs (with UV Sync Selection, Select Mirror Image does that)"""

    bl_idname = "intrinsic_symmetry.select_uv"
    bl_label = "Select Mirror Image of UVs"

    extend: bpy.props.BoolProperty(name="Extend", description="Keep the current selection too", default=False)

    @classmethod
    def lacks(cls, context, object):
        problem = super().lacks(context, object)
        if problem is None and not object.data.uv_layers:
            problem = "The mesh has no UV map"
        if problem is None and context.tool_settings.use_uv_select_sync:
            problem = "UV Sync Selection is on: use Select Mirror Image"
        return problem

    def run_with(self, symmetry, _context, object, _mode):
        mesh = object.data
        corner_name, edge_name, face_name = names(mesh)
        stored = mesh.attributes.get(corner_name)
        if stored is None or not (selected := mesh_data.read_attribute(stored)).any():
            raise mesh_data.NothingSelected("No UVs are selected")
        mirrored = _mirrored(mesh, symmetry, selected)
        if self.extend:
            mirrored |= selected
        offsets, following = _following(mesh)
        mesh_data.write_attribute(mesh, corner_name, "BOOLEAN", mirrored, "CORNER")
        mesh_data.write_attribute(mesh, edge_name, "BOOLEAN", mirrored & mirrored[following], "CORNER")
        if face_name is not None:
            whole = np.logical_and.reduceat(mirrored, offsets[:-1])
            mesh_data.write_attribute(mesh, face_name, "BOOLEAN", whole, "FACE")
        return f"{int(mirrored.sum())} UVs selected"


def _mirrored(mesh, symmetry, selected):
    """(corners,) bool: corners whose mirror image is selected; a corner that has none, if most of the face is that
    holds the mirror image of its own."""
    faces = face_partners(mesh, symmetry)
    partners = corner_partners(mesh, symmetry.partner, faces)
    offsets, _ = mesh_data.polygons(mesh)
    share = np.add.reduceat(selected.astype(float), offsets[:-1]) / np.diff(offsets)
    face_of = np.repeat(faces, np.diff(offsets))
    of_face = (face_of >= 0) & (share[face_of] > 0.5)
    return np.where(partners < 0, of_face, selected[partners])


def _following(mesh):
    """Offsets of the faces, and (corners,) the next corner of each corner's face."""
    offsets, corners = mesh_data.polygons(mesh)
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    return offsets, following


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_select_uv,))
