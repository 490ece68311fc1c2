# SPDX-License-Identifier: GPL-3.0-or-later
"""Select the mirror image of the selection, the line between left and right, or all up to that line."""

import bpy
import numpy as np

from . import mesh_data, stored_map
from .elements import edge_partners
from .operator_base import MapOperator


def write_selection(context, mesh, vertices, edges=None, faces=None):
    """Selects vertices, (vertices,) bool, but hidden ones, and all edges and faces between them, of those that are
    given; as the select mode has it, so that Blender adds nothing. Returns how many vertices are selected.

    The attributes are written by name: `mesh.edges.foreach_set("select", ...)` can crash Blender 5.0."""
    vertices = vertices & (mesh_data.changeable(mesh, "EDIT") > 0)
    vertex_mode, edge_mode, _ = context.tool_settings.mesh_select_mode
    ends, (offsets, corners) = mesh_data.edges(mesh), mesh_data.polygons(mesh)
    chosen_edges = vertices[ends].all(axis=1) & (True if edges is None else edges)
    whole = vertices[corners] if vertex_mode or not edge_mode else chosen_edges[mesh_data.edges_of_corners(mesh)]
    chosen_faces = np.logical_and.reduceat(whole, offsets[:-1]) if len(corners) else np.zeros(0, bool)
    chosen_faces &= True if faces is None else faces
    if not vertex_mode:
        of_faces = np.repeat(chosen_faces, np.diff(offsets))
        if not edge_mode:
            chosen_edges = np.zeros_like(chosen_edges)
            chosen_edges[mesh_data.edges_of_corners(mesh)[of_faces]] = True
        vertices = np.zeros_like(vertices)
        vertices[ends[chosen_edges]] = True
    for name, domain, flags in (
        (".select_vert", "POINT", vertices),
        (".select_edge", "EDGE", chosen_edges),
        (".select_poly", "FACE", chosen_faces),
    ):
        mesh_data.write_attribute(mesh, name, "BOOLEAN", flags, domain)
    mesh.update()
    return int(vertices.sum())


def _flags(elements):
    flags = np.empty(len(elements), bool)
    elements.foreach_get("select", flags)
    return flags


class INTRINSIC_SYMMETRY_OT_select(MapOperator, bpy.types.Operator):
    """Select the mirror image of the selected vertices, edges or faces"""

    bl_idname = "intrinsic_symmetry.select"
    bl_label = "Select Mirror Image"

    extend: bpy.props.BoolProperty(name="Extend", description="Keep the current selection too", default=False)
    minimum_confidence: bpy.props.FloatProperty(
        name="Minimum Confidence",
        description="Select only vertices whose mirror image is at least as certain",
        min=0.0, max=1.0, default=0.0, subtype="FACTOR",
    )

    def run_with(self, symmetry, context, object, _mode):
        mesh = object.data
        selected = mesh_data.selected_vertices(mesh)
        if not selected.any():
            raise mesh_data.NothingSelected("Nothing is selected")
        how = {"minimum_confidence": self.minimum_confidence}
        vertices = symmetry.mirror_selection(selected, **how)
        vertex_mode, edge_mode, _ = context.tool_settings.mesh_select_mode
        edges = faces = None
        if edge_mode and not vertex_mode:
            edges = _mirrored_edges(mesh, symmetry)
        elif not vertex_mode:
            vertices = np.ones_like(selected)  # the faces alone decide
            faces = symmetry.mirror_face_selection(_flags(mesh.polygons), **how)
        if self.extend:
            vertices = vertices | selected
            edges = edges if edges is None else edges | _flags(mesh.edges)
            faces = faces if faces is None else faces | _flags(mesh.polygons)
        return f"{write_selection(context, mesh, vertices, edges, faces)} vertices selected"


def _mirrored_edges(mesh, symmetry):
    """(edges,) bool: an edge whose mirror image is an edge of the mesh is selected only with that; any other, whose
    connectivity has no counterpart, may be."""
    partners = edge_partners(mesh, symmetry.partner)
    return np.where(partners < 0, True, _flags(mesh.edges)[partners])


class INTRINSIC_SYMMETRY_OT_select_line(MapOperator, bpy.types.Operator):
    """Select the line between left and right: an edge loop where there is one, else the vertices nearest to it"""

    bl_idname = "intrinsic_symmetry.select_line"
    bl_label = "Select Symmetry Line"

    extend: bpy.props.BoolProperty(name="Extend", description="Keep the current selection too", default=False)

    def run_with(self, _symmetry, context, object, _mode):
        mesh, lines = object.data, stored_map.fixed_lines(object.data)
        if not lines:
            raise mesh_data.MeshProblem("This symmetry has no line between left and right")
        vertices = np.zeros(len(mesh.vertices), bool)
        steps = set()
        for line in lines:
            near = line.nearest_vertices()
            vertices[near] = True
            following = np.roll(near, -1) if line.closed else near[1:]
            steps.update(tuple(sorted(step)) for step in zip(near.tolist(), following.tolist()))
        edges = np.fromiter((tuple(sorted(e)) in steps for e in mesh_data.edges(mesh).tolist()), bool)
        if self.extend:
            vertices, edges = vertices | mesh_data.selected_vertices(mesh), edges | _flags(mesh.edges)
        if not any(context.tool_settings.mesh_select_mode[:2]):
            raise mesh_data.MeshProblem("A line has no faces: go to vertex or edge select mode")
        faces = _flags(mesh.polygons) if self.extend else np.zeros(len(mesh.polygons), bool)
        return f"{write_selection(context, mesh, vertices, edges, faces)} vertices selected"


class INTRINSIC_SYMMETRY_OT_select_to_line(MapOperator, bpy.types.Operator):
    """Grow the selection over its side, up to the line between left and right"""

    bl_idname = "intrinsic_symmetry.select_to_line"
    bl_label = "Grow to Symmetry Line"

    def run_with(self, symmetry, context, object, _mode):
        mesh = object.data
        selected = mesh_data.selected_vertices(mesh)
        if not selected.any():
            raise mesh_data.NothingSelected("Nothing is selected")
        grown = _flood(selected, mesh_data.edges(mesh), symmetry.side)
        return f"{write_selection(context, mesh, grown)} vertices selected"


def _flood(selected, ends, side):
    """(vertices,) bool: all that can be reached from the selection without leaving its side or crossing the line."""
    same_side = (side[ends[:, 0]] == side[ends[:, 1]]) & (side[ends[:, 0]] != 0)
    inner, grown = ends[same_side], selected.copy()
    while True:
        reached = grown[inner].any(axis=1)
        before = grown.sum()
        grown[inner[reached].ravel()] = True
        if grown.sum() == before:
            break
    border = ends[(side[ends] == 0).sum(axis=1) == 1]
    touched = border[grown[border].any(axis=1)].ravel()
    grown[touched[side[touched] == 0]] = True
    return grown


register, unregister = bpy.utils.register_classes_factory(
    (
        INTRINSIC_SYMMETRY_OT_select,
        INTRINSIC_SYMMETRY_OT_select_line,
        INTRINSIC_SYMMETRY_OT_select_to_line,
    )
)
